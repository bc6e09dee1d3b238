"""Built-in contact laws, one a file."""

from __future__ import annotations

from raceway.contact_laws.hertz import Hertz
from raceway.contact_laws.penalty import Penalty
from raceway.contact_laws.unilateral import Unilateral
from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_contact_laws() -> list[type]:
    return [Hertz, Penalty, Unilateral]
