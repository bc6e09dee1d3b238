"""Built-in contact laws.

hertz     exact elliptic Hertz contact
penalty   pressure in proportion to penetration, at surface points or integrated over the overlap ellipse; unilateral: none at all
line      line contacts of rollers: constants of ISO/TS 16281 and Palmgren
film      Hertz behind an elastohydrodynamic film; viscosity of the lubricant at a temperature
"""

from __future__ import annotations

from raceway.contact_laws.film import Film
from raceway.contact_laws.hertz import Hertz
from raceway.contact_laws.line import Line
from raceway.contact_laws.penalty import Penalty, Unilateral
from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_contact_laws() -> list[type]:
    return [Hertz, Penalty, Unilateral, Film, Line]
