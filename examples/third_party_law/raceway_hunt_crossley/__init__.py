"""Hunt-Crossley contact law for Raceway."""

from __future__ import annotations

from raceway import hookimpl
from raceway_hunt_crossley.law import HuntCrossley


@hookimpl
def raceway_contact_laws() -> list[type]:
    return [HuntCrossley]
