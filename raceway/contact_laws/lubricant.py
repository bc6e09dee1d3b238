"""Viscosity of a lubricant at a temperature."""

from __future__ import annotations

from math import log, log10

import attrs

#: Mineral oils by their ISO viscosity grade: kinematic viscosity at 40 and at 100 C [mm2/s].  At 40 C it is the grade's
#: mid-point by definition (ISO 3448), at 100 C that of a viscosity index of 95 (ASTM D2270, inverted), the index that charts of
#: straight mineral oils are drawn for.
GRADES: dict[str, tuple[float, float]] = {
    "VG 10": (10.0, 2.64), "VG 15": (15.0, 3.38), "VG 22": (22.0, 4.25), "VG 32": (32.0, 5.29), "VG 46": (46.0, 6.65),
    "VG 68": (68.0, 8.53), "VG 100": (100.0, 11.1), "VG 150": (150.0, 14.5), "VG 220": (220.0, 18.8),
}  # fmt: skip
#: Temperatures [C] over which a line through two measured viscosities is used.
COLDEST, HOTTEST = 0.0, 140.0
_AT, _ZERO = (40.0, 100.0), 273.15


@attrs.frozen
class Walther:
    """log10 log10(nu + 0.7) falls linearly with log10 T, nu in mm2/s and T in K (ASTM D341, Walther 1931)."""

    at_40: float
    at_100: float

    def viscosity(self, temperature: float) -> float:
        """Kinematic viscosity [mm2/s] at a temperature [C]."""
        x = [log10(each + _ZERO) for each in (*_AT, temperature)]
        y = [log10(log10(each + 0.7)) for each in (self.at_40, self.at_100)]
        at = y[0] + (y[1] - y[0]) * (x[2] - x[0]) / (x[1] - x[0])
        return float(10.0**10.0**at - 0.7)

    def thinning(self, temperature: float) -> float:
        """beta = -d ln(nu) / dT [1/K] at a temperature [C]; the density's part, 7e-4 1/K, is left out."""
        return log(self.viscosity(temperature - 0.01) / self.viscosity(temperature + 0.01)) / 0.02


def mineral_thinning(viscosity: float, temperature: float) -> float:
    """beta [1/K] of the mineral oil that has this kinematic viscosity [mm2/s] at a temperature [C], between those of ``GRADES``."""
    from numpy import interp

    at, oils = min(max(temperature, COLDEST), HOTTEST), [Walther(*pair) for pair in GRADES.values()]
    return float(interp(log(viscosity), [log(oil.viscosity(at)) for oil in oils], [oil.thinning(at) for oil in oils]))


def pressure_viscosity(viscosity: float) -> float:
    """Coefficient alpha [1/Pa] of a mineral oil from its viscosity [Pa s] at the same temperature.

    Notes
    -----
    Wooster's rule alpha = (0.6 + 0.965 log10 eta) 1e-8 with eta in mPa s, at least 0.6e-8: an estimate, which was not seen in
    its own source.  Of the coefficients measured on thirteen mineral oils at 30 to 100 C it gives 0.70 to 1.17 times
    (``MEASURED`` in validation/film.py), which moves a film, h ~ alpha^0.53, by less than a fifth.

    References
    ----------
    Stachowiak, Batchelor, Engineering Tribology, chapter 2 with table 2.3 of measured coefficients.
    """
    return 1e-8 * (0.6 + 0.965 * max(log10(max(1e3 * viscosity, 1.0)), 0.0))
