"""Built-in contact laws.

hertz     exact elliptic Hertz contact
penalty   pressure in proportion to penetration, at surface points or integrated over the overlap ellipse; unilateral: none at all
line      line contacts of rollers: constants of ISO/TS 16281 and Palmgren
film      Hertz behind an elastohydrodynamic film; viscosity of the lubricant at a temperature
"""

from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_contact_laws() -> dict[str, str]:
    return {
        "hertz": "raceway.contact_laws.hertz:Hertz",
        "penalty": "raceway.contact_laws.penalty:Penalty",
        "unilateral": "raceway.contact_laws.penalty:Unilateral",
        "film": "raceway.contact_laws.film:Film",
        "line": "raceway.contact_laws.line:Line",
    }
