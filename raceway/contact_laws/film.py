"""Hertz contacts that an elastohydrodynamic film keeps apart."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.core.columns import Number, largest, least, log, log10, where
from raceway.framework.contracts import LawReport
from raceway.framework.options import between, nearest, one_of, option, optional, positive

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.contact.film import Film as Thickness
    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs
    from raceway.storage.tables import Tables


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

    at_40: Number
    at_100: Number

    def viscosity(self, temperature: Number) -> Number:
        """Kinematic viscosity [mm2/s] at a temperature [C]."""
        x = [log10(each + _ZERO) for each in (*_AT, temperature)]
        y = [log10(log10(each + 0.7)) for each in (self.at_40, self.at_100)]
        at = y[0] + (y[1] - y[0]) * (x[2] - x[0]) / (x[1] - x[0])
        return 10.0**10.0**at - 0.7

    def thinning(self, temperature: Number) -> Number:
        """beta = -d ln(nu) / dT [1/K] at a temperature [C]; the density's part, 7e-4 1/K, is left out."""
        return log(self.viscosity(temperature - 0.01) / self.viscosity(temperature + 0.01)) / 0.02


def _mineral_thinning(viscosity: Number, temperature: Number) -> Number:
    """beta [1/K] of the mineral oil that has this kinematic viscosity [mm2/s] at a temperature [C], between those of ``GRADES``."""
    at, oils = least(largest(temperature, COLDEST), HOTTEST), [Walther(*pair) for pair in GRADES.values()]
    nodes, betas = [log(oil.viscosity(at)) for oil in oils], [oil.thinning(at) for oil in oils]
    x, beta = least(largest(log(viscosity), nodes[0]), nodes[-1]), betas[0]
    for k in range(len(oils) - 1):
        slope = (betas[k + 1] - betas[k]) / (nodes[k + 1] - nodes[k])
        beta = where(x >= nodes[k], slope * (x - nodes[k]) + betas[k], beta)
    return beta


def pressure_viscosity(viscosity: Number) -> Number:
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
    return 1e-8 * (0.6 + 0.965 * largest(log10(largest(1e3 * viscosity, 1.0)), 0.0))


#: Lambda below which surfaces carry through asperities.
_MIXED, _BOUNDARY = 3.0, 1.0
#: Thermal reduction that is reported as strong, and the thermal loading to which its formula was compared with Grubin's inlet.
_STRONG, _LOADING = 0.5, 100.0


@attrs.frozen
class Film:
    """Hertz contact behind an oil film (Hamrock and Dowson): the surfaces stand off by the central film thickness,
    which the heat of shear in the inlet reduces (Murch and Wilson).

    Notes
    -----
    The thickness belongs to the running speed, the loaded contact angles and each contact's load Q0 in the equilibrium.  Its
    dependence on the load, h = h0 (Q/Q0)^-e, is kept to first order in the elastic approach d: h = h0 (1 + m - m d/d0), m = 1.5 e.
    The force by the gap is then again a power of 1.5, K' (reach - gap)^1.5 with reach = (1 + m) h0 and
    K' = K / (1 + m h0/d0)^1.5: exact in force and stiffness at Q0, and as quick as Hertz.
    """

    name: ClassVar[str] = "film"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    renewed: ClassVar[bool] = True
    elementwise: ClassVar[bool] = True

    oil: str | None = option(None, help=f"mineral oil by its grade: {', '.join(GRADES)}; needs temperature_c")
    viscosity_40: float | None = option(
        None, unit="m2/s", help="kinematic, at 40 C (32e-6 is 32 mm2/s); with viscosity_100", rule=optional(positive())
    )
    viscosity_100: float | None = option(None, unit="m2/s", help="kinematic, at 100 C", rule=optional(positive()))
    viscosity: float | None = option(
        None, unit="Pa s", help="dynamic, at the running temperature, instead of an oil", rule=optional(positive())
    )
    temperature_c: float | None = option(
        None, unit="°C", help="of the oil in the inlets of the contacts", rule=optional(between(-273.15, 1e3))
    )
    density: float = option(870.0, unit="kg/m3", help="of the oil", rule=positive())
    pressure_viscosity: float | None = option(
        None,
        unit="1/Pa",
        help="coefficient alpha; default: Wooster's rule for mineral oils, from the viscosity",
        rule=optional(between(1e-11, 1e-6)),
    )
    inlet_heating: str = option(
        "murch_wilson", help="thins the film: by 'murch_wilson', or 'none' (isothermal)", rule=one_of("murch_wilson", "none")
    )
    temperature_viscosity: float | None = option(
        None, unit="1/K", help="beta = -d ln(viscosity)/dT; default: the oil's, or mineral oils'", rule=optional(positive())
    )
    conductivity: float = option(0.14, unit="W/m/K", help="of the oil; mineral oils have 0.12 to 0.15", rule=positive())
    starvation: float = option(1.0, help="thickness over that of a flooded contact", rule=between(0.0, 1.0))
    roughness: float | None = option(
        None, unit="m", help="rms of both surfaces together, sqrt(R1^2 + R2^2), for Lambda", rule=optional(positive())
    )

    def __attrs_post_init__(self) -> None:
        pair = self.viscosity_40 is not None or self.viscosity_100 is not None
        ways = sum((self.oil is not None, pair, self.viscosity is not None))
        if ways != 1:
            mistake = "no viscosity is given" if ways == 0 else "the viscosity is given more than once"
            raise ValueError(
                f"{mistake}: give `oil` (such as 'VG 32') or `viscosity_40` with `viscosity_100`, both with `temperature_c`, or "
                "`viscosity` at the running temperature"
            )
        if self.viscosity is not None:
            return
        if self.oil is not None and self.oil not in GRADES:
            raise ValueError(f"`oil` = {self.oil!r} is not known{nearest(self.oil, GRADES)}: {', '.join(GRADES)}")
        if pair and (self.viscosity_40 is None or self.viscosity_100 is None):
            raise ValueError(
                "`viscosity_40` and `viscosity_100` belong together: two points make a line over the temperature"
            )
        if self.viscosity_40 is not None and self.viscosity_100 is not None and self.viscosity_40 <= self.viscosity_100:
            raise ValueError(
                f"`viscosity_100` = {self.viscosity_100:g} m2/s must be below `viscosity_40` = {self.viscosity_40:g} m2/s: oils "
                "thin as they warm"
            )
        if min(self._line.at_40, self._line.at_100) <= 0.3:
            raise ValueError("`viscosity_100` must be above 0.3e-6 m2/s, where Walther's line over the temperature ends")
        if self.temperature_c is None:
            raise ValueError("`temperature_c` is missing: the viscosity of an oil belongs to a temperature")
        if not COLDEST <= self.temperature_c <= HOTTEST:
            raise ValueError(
                f"`temperature_c` = {self.temperature_c:g} is outside the oil's data: Walther's line through 40 and 100 C is used from "
                f"{COLDEST:g} to {HOTTEST:g} C. Give `viscosity` at that temperature instead"
            )

    @classmethod
    def examples(cls) -> list[Film]:
        """Instances for the conformance suite; rules for mineral oils hold in SI units alone."""
        return [
            cls(viscosity=0.03, pressure_viscosity=2e-8, temperature_viscosity=0.03),
            cls(viscosity=0.3, pressure_viscosity=1e-8, temperature_viscosity=0.05, starvation=0.5),
        ]

    @property
    def _line(self) -> Walther:
        if self.oil is not None:
            return Walther(*GRADES[self.oil])
        assert self.viscosity_40 is not None and self.viscosity_100 is not None, "checked when made"
        return Walther(1e6 * self.viscosity_40, 1e6 * self.viscosity_100)

    @property
    def dynamic_viscosity(self) -> Number:
        """eta [Pa s] at the running temperature."""
        if self.viscosity is not None:
            return self.viscosity
        assert self.temperature_c is not None, "checked when made"
        return 1e-6 * self._line.viscosity(self.temperature_c) * self.density

    @property
    def alpha(self) -> Number:
        """Pressure-viscosity coefficient [1/Pa]."""
        coefficient = self.pressure_viscosity
        return pressure_viscosity(self.dynamic_viscosity) if coefficient is None else coefficient

    @property
    def beta(self) -> Number:
        """Temperature-viscosity coefficient [1/K]; of a viscosity alone that of the mineral oil that has it, at 40 C by default."""
        at = 40.0 if self.temperature_c is None else self.temperature_c
        if self.temperature_viscosity is not None:
            return self.temperature_viscosity
        if self.viscosity is None:
            return self._line.thinning(at)
        return _mineral_thinning(1e6 * self.viscosity / self.density, at)

    def inlet(self, pairs: ContactPairs) -> tuple[np.ndarray, np.ndarray]:
        """Thermal loading of the contacts' inlets (n,), and the part of the isothermal film that their heat leaves (n,)."""
        from raceway.core.contact.film import thermal_reduction

        assert pairs.entraining_speed is not None, "bodies that renew laws give it"
        loading = self.dynamic_viscosity * self.beta * pairs.entraining_speed**2 / self.conductivity
        return loading, thermal_reduction(loading)

    def _reduction(self, pairs: ContactPairs) -> np.ndarray:
        reduction = self.inlet(pairs)[1]
        return reduction**0 if self.inlet_heating == "none" else reduction

    def thickness(self, pairs: ContactPairs) -> Thickness:
        """Films of the contacts at their entraining speeds and loads."""
        from raceway.core.contact.film import film

        speed, load = pairs.entraining_speed, pairs.load
        assert speed is not None and load is not None, "bodies that renew laws give them"
        computed = film(
            self.dynamic_viscosity * speed, self.alpha, 2.0 * pairs.contact_modulus, pairs.radius_along, pairs.radius_across,
            load, pairs.ellipticity,
        )  # fmt: skip
        part = self.starvation * self._reduction(pairs)
        return attrs.evolve(computed, central=part * computed.central, minimum=part * computed.minimum)

    def _slope(self, pairs: ContactPairs) -> tuple[np.ndarray, np.ndarray]:
        """h0 (n,) [m] and m (n,), by which the film thins as the elastic approach grows."""
        thickness = self.thickness(pairs)
        return thickness.central, -1.5 * thickness.by_load

    def build(self, pairs: ContactPairs) -> np.ndarray:
        import numpy as np

        if pairs.entraining_speed is None or pairs.load is None:
            return pairs.hertz_factor[:, np.newaxis]
        thick, slope = self._slope(pairs)
        approach = np.cbrt(pairs.load / pairs.hertz_factor) ** 2
        return np.asarray(pairs.hertz_factor / (1.0 + slope * thick / approach) ** 1.5)[:, np.newaxis]

    def reach(self, pairs: ContactPairs) -> np.ndarray:
        thick, slope = self._slope(pairs)
        return (1.0 + slope) * thick

    def kernel(self) -> Kernel:
        from raceway.core.contact.laws import three_halves

        return three_halves

    def report(self, pairs: ContactPairs) -> LawReport:
        """Thickness, Lambda and regime of every contact, and what makes them doubtful."""
        import numpy as np

        from raceway.core.contact.film import REGIMES

        films, reduction = self.thickness(pairs), self._reduction(pairs)
        lambdas = films.minimum / self.roughness if self.roughness is not None else np.full_like(films.minimum, np.nan)
        columns = {
            "film_central_m": films.central,
            "film_minimum_m": films.minimum,
            "film_isothermal_m": films.central / reduction,
            "film_thermal_reduction": reduction,
            "film_parameter": lambdas,
            "film_regime": np.array(REGIMES)[films.regime],
            "entraining_speed_m_per_s": np.asarray(pairs.entraining_speed),
        }
        table: Tables = {"viscosity_pa_s": self.dynamic_viscosity, "pressure_viscosity_per_pa": self.alpha}
        table |= {"inlet_heating": self.inlet_heating, "temperature_viscosity_per_k": self.beta}
        return LawReport(columns, table, (*self._heated(pairs), *_doubts(films), *self._rough(lambdas)))

    def _heated(self, pairs: ContactPairs) -> list[str]:
        """A sentence where the heat of the inlet decides the film, from speed and viscosity."""
        loading, reduction = self.inlet(pairs)
        if reduction.min() >= _STRONG:
            return []
        speed = 0.0 if pairs.entraining_speed is None else float(pairs.entraining_speed.max())
        beyond = f", beyond the {_LOADING:g} that the formula was checked to" if loading.max() > _LOADING else ""
        leaves = "leaves"
        remedy = "Measure the oil's contact.temperature_viscosity and contact.conductivity, or take a thinner oil"
        if self.inlet_heating == "none":
            leaves, remedy = "would leave", "Take it off by contact.inlet_heating = 'murch_wilson'"
        return [
            f"the heat of the inlets {leaves} {reduction.min():.2g} of the film, at {1e3 * self.dynamic_viscosity:.3g} mPa s and "
            f"{speed:.3g} m/s (thermal loading {loading.max():.3g}{beyond}): published formulas differ by up to a fifth there. {remedy}"
        ]

    def _rough(self, lambdas: np.ndarray) -> list[str]:
        """A sentence where asperities carry."""
        if self.roughness is None:
            return []
        thinnest = float(lambdas.min())
        sentence = f"Lambda = h_min / roughness is {thinnest:.2g} at the thinnest film"
        if thinnest < _BOUNDARY:
            return [
                f"boundary lubrication: {sentence}, below {_BOUNDARY:g}: the surfaces touch, and the film of smooth surfaces is not what "
                "carries. Take a thicker oil, a higher speed or smoother surfaces, or contact.kind = 'hertz'"
            ]
        return [f"mixed lubrication: {sentence}, below {_MIXED:g}: asperities carry a part"] if thinnest < _MIXED else []


def _doubts(thickness: Thickness) -> list[str]:
    """A sentence where contacts are in another regime than rolling bearings' usual one."""
    from raceway.core.contact.film import REGIMES

    regimes = sorted({REGIMES[each] for each in thickness.regime if each != 0})
    words = " and ".join(regimes)
    return [f"contacts are not in the piezoviscous-elastic regime of rolling bearings but {words}"] if regimes else []
