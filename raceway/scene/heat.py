"""The table ``[heat]``: what carries a bearing's heat off, from which its steady temperatures are computed."""

from __future__ import annotations

import attrs

from raceway.framework.options import between, inside, option, word_or

#: Conductance [W/K] beyond which it is 'infinite': differences of temperatures, known to 1e-13 K, no longer give the heat to 1e-8 W.
_INFINITE = 1e5


def _conductance(between_words: str) -> float | str:
    rule = word_or(inside(1e-12, _INFINITE), "auto", "infinite")
    return option("auto", unit="W/K", help=f"conductance between {between_words}", rule=rule)


def _to_ambient(node: str) -> float | str:
    return option(
        "auto",
        unit="W/K",
        help=f"conductance between {node} and ambient; 'auto': by ISO 15312",
        rule=word_or(inside(1e-12, _INFINITE), "auto"),
    )


@attrs.frozen
class Heat:
    """Temperatures of rings, balls and oil are computed from the heat of friction; conductances are those of all rows together.

    Notes
    -----
    Conductances that are 'auto' follow from correlations (``raceway.core.thermal``), those to the ambient from ISO 15312.
    """

    oil_inlet_c: float = option(unit="°C", help="temperature of the supplied oil", rule=between(-273.15, 1e3))
    oil_flow: float | str = option(
        unit="m3/s",
        help="flow through all rows; 'infinite': constant oil temperature",
        rule=word_or(inside(1e-18, 1.0), "infinite"),
    )
    ambient_c: float = option(20.0, unit="°C", help="temperature around shaft and housing", rule=between(-150.0, 1e3))
    oil_heat_capacity: float = option(2000.0, unit="J/kg/K", help="of the oil; usually 1900 to 2300", rule=between(1.0, 1e5))
    inner_wetting: float | str = option(
        "auto",
        help="wetted share of the inner rings, a factor of inner_oil 'auto'; 'auto': 1 - Z D / (pi d_m), the gaps between the balls; "
        "under-race lubrication: 1",
        rule=word_or(between(1e-3, 1.0), "auto"),
    )
    inner_balls: float | str = _conductance("inner rings and balls")
    outer_balls: float | str = _conductance("outer rings and balls")
    inner_oil: float | str = _conductance("inner rings and oil")
    balls_oil: float | str = _conductance("balls and oil")
    outer_oil: float | str = _conductance("outer rings and oil")
    inner_shaft: float | str = _conductance("inner rings and shaft")
    outer_housing: float | str = _conductance("outer rings and housing")
    shaft_ambient: float | str = _to_ambient("shaft")
    housing_ambient: float | str = _to_ambient("housing")
    conductance_band: float = option(
        0.5, help="r: 'auto' conductances are uncertain by factors 1/(1 + r) to 1 + r", rule=between(0.0, 100.0)
    )
