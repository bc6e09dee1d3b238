"""Built-in contact laws, one a file.

hertz        exact elliptic Hertz contact
penalty      pressure in proportion to penetration, at surface points or integrated over the overlap ellipse
unilateral   no penetration: an active set at surface points
film         Hertz behind an elastohydrodynamic film;  lubricant: viscosity at a temperature
stiffness    penalty stiffness from a share of Hertz's approach
"""

from __future__ import annotations

from raceway.contact_laws.film import Film
from raceway.contact_laws.hertz import Hertz
from raceway.contact_laws.penalty import Penalty
from raceway.contact_laws.unilateral import Unilateral
from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_contact_laws() -> list[type]:
    return [Hertz, Penalty, Unilateral, Film]
