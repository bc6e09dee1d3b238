"""Lubricants: viscosity over temperature and pressure of an oil, and the table [lubricant]."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import attrs

from raceway.core.columns import Number, largest, least, log, log10, where, with_values
from raceway.errors import Mistake
from raceway.framework.options import at_least, between, nearest, option, positive, word_or

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.contact.film import Film
    from raceway.core.quantities.rolling_friction import Lubrication
    from raceway.framework.contracts import ContactPairs

T = TypeVar("T", bound=Any)

#: Mineral oils by their ISO viscosity grade: kinematic viscosity at 40 and at 100 C [mm2/s].  At 40 C it is the grade's
#: mid-point by definition (ISO 3448), at 100 C that of a viscosity index of 95 (ASTM D2270, inverted), the index that charts of
#: straight mineral oils are drawn for.
GRADES: dict[str, tuple[float, float]] = {
    "VG 10": (10.0, 2.64), "VG 15": (15.0, 3.38), "VG 22": (22.0, 4.25), "VG 32": (32.0, 5.29), "VG 46": (46.0, 6.65),
    "VG 68": (68.0, 8.53), "VG 100": (100.0, 11.1), "VG 150": (150.0, 14.5), "VG 220": (220.0, 18.8),
}  # fmt: skip
#: How an oil is given.
_WAYS = "give `oil` (such as 'VG 32') or `viscosity_40` with `viscosity_100`, both with `temperature_c`, or `viscosity` at the running temperature"
#: Temperatures [C] over which a line through two measured viscosities is used.
COLDEST, HOTTEST = 0.0, 140.0
_AT, _ZERO = (40.0, 100.0), 273.15


@attrs.frozen
class Walther:
    """log10 log10(nu + 0.7) falls linearly with log10 T, nu in mm2/s and T in K (ASTM D341, Walther 1931); numbers may be columns."""

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


def mineral_thinning(viscosity: Number, temperature: Number) -> Number:
    """beta [1/K] of the mineral oil that has this kinematic viscosity [mm2/s] at a temperature [C], between those of ``GRADES``."""
    at, logarithm = least(largest(temperature, COLDEST), HOTTEST), log(viscosity)
    nodes = [(log(oil.viscosity(at)), oil.thinning(at)) for oil in (Walther(*pair) for pair in GRADES.values())]
    thinning = nodes[0][1]
    for (low, first), (high, last) in pairwise(nodes):
        thinning = where(logarithm > low, (last - first) / (high - low) * (least(logarithm, high) - low) + first, thinning)
    return where(logarithm >= nodes[-1][0], nodes[-1][1], thinning)


def pressure_viscosity(viscosity: Number) -> Number:
    """Coefficient alpha [1/Pa] of a mineral oil from its viscosity [Pa s] at the same temperature.

    Wooster's rule alpha = (0.6 + 0.965 log10 eta) 1e-8 with eta in mPa s, at least 0.6e-8: an estimate.  Of the coefficients measured on
    thirteen mineral oils at 30 to 100 C it gives 0.70 to 1.17 times (checks/validation/film.py), which moves a film,
    h ~ alpha^0.53, by less than a fifth.

    Stachowiak, Batchelor, Engineering Tribology, chapter 2 with table 2.3 of measured coefficients.
    """
    return 1e-8 * (0.6 + 0.965 * largest(log10(largest(1e3 * viscosity, 1.0)), 0.0))


@attrs.frozen
class Oil:
    """Viscosity of an oil at a temperature; of the keys one way to give it, or none."""

    oil: str | None = option(None, help=f"mineral oil by its grade: {', '.join(GRADES)}; needs temperature_c")
    viscosity_40: float | None = option(
        None, unit="m2/s", help="kinematic, at 40 C (32e-6 is 32 mm2/s); with viscosity_100", rule=positive()
    )
    viscosity_100: float | None = option(None, unit="m2/s", help="kinematic, at 100 C", rule=positive())
    viscosity: float | None = option(
        None, unit="Pa s", help="dynamic, at the running temperature; excludes oil", rule=positive()
    )
    temperature_c: float | None = option(
        None, unit="°C", help="of the oil in the inlets of the contacts", rule=between(-273.15, 1e3)
    )
    density: float = option(870.0, unit="kg/m3", help="of the oil", rule=positive())
    pressure_viscosity: float | None = option(
        None,
        unit="1/Pa",
        help="coefficient alpha; default: Wooster's rule for mineral oils, from the viscosity",
        rule=between(1e-11, 1e-6),
    )
    temperature_viscosity: float | None = option(
        None, unit="1/K", help="beta = -d ln(viscosity)/dT; default: the oil's, or mineral oils'", rule=positive()
    )
    conductivity: float = option(0.14, unit="W/m/K", help="of the oil; mineral oils: 0.12 to 0.15", rule=positive())

    def __attrs_post_init__(self) -> None:
        pair = self.viscosity_40 is not None or self.viscosity_100 is not None
        ways = sum((self.oil is not None, pair, self.viscosity is not None))
        if ways > 1:
            raise ValueError(f"the viscosity is given more than once: {_WAYS}")
        if self.viscosity is not None or ways == 0:
            return
        if self.oil is not None and self.oil not in GRADES:
            raise ValueError(f"`oil` = {self.oil!r} is not known{nearest(self.oil, GRADES)}: {', '.join(GRADES)}")
        if pair and (self.viscosity_40 is None or self.viscosity_100 is None):
            raise ValueError("`viscosity_40` and `viscosity_100` belong together: a line needs two points")
        if self.viscosity_40 is not None and self.viscosity_100 is not None and self.viscosity_40 <= self.viscosity_100:
            rule = f"must be below `viscosity_40` = {self.viscosity_40:g} m2/s: oils thin as they warm"
            raise ValueError(f"`viscosity_100` = {self.viscosity_100:g} m2/s {rule}")
        if min(self._walther.at_40, self._walther.at_100) <= 0.3:
            raise ValueError("`viscosity_100` must be above 0.3e-6 m2/s, where Walther's line over the temperature ends")
        if self.temperature_c is None:
            raise ValueError("`temperature_c` is missing: the viscosity of an oil belongs to a temperature")
        if not COLDEST <= self.temperature_c <= HOTTEST:
            rule = f"Walther's line through 40 and 100 C is used from {COLDEST:g} to {HOTTEST:g} C"
            fault = f"`temperature_c` = {self.temperature_c:g} is outside the oil's data: {rule}"
            raise ValueError(f"{fault}. Give `viscosity` at that temperature instead")

    @property
    def thins(self) -> bool:
        """Whether the viscosity is known over the temperature: by a grade or two points, not by one number."""
        return self.oil is not None or self.viscosity_40 is not None

    @property
    def known(self) -> bool:
        """Whether a viscosity is given."""
        return self.thins or self.viscosity is not None

    def at(self, temperature_c: Number) -> Oil:
        """The same oil at another temperature [C], which no rule looks at; may be a column."""
        return with_values(self, temperature_c=temperature_c)

    @property
    def _walther(self) -> Walther:
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
        return 1e-6 * self._walther.viscosity(self.temperature_c) * self.density

    @property
    def kinematic_viscosity(self) -> Number:
        """nu = eta / density [m2/s] at the running temperature."""
        return self.dynamic_viscosity / self.density

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
            return self._walther.thinning(at)
        return mineral_thinning(1e6 * self.viscosity / self.density, at)

    def inlet(self, pairs: ContactPairs) -> tuple[np.ndarray, np.ndarray]:
        """Thermal loading of the contacts' inlets (n,), and the part of the isothermal film that their heat leaves (n,)."""
        from raceway.core.contact.film import thermal_reduction

        assert pairs.entraining_speed is not None, "contacts at the running speed have it"
        loading = self.dynamic_viscosity * self.beta * pairs.entraining_speed**2 / self.conductivity
        return loading, thermal_reduction(loading)

    def film_share(self, pairs: ContactPairs) -> np.ndarray:
        """What the heat of the inlets leaves of a flooded, isothermal film (n,)."""
        return self.inlet(pairs)[1]

    def thickness(self, pairs: ContactPairs) -> Film:
        """Films of the contacts at their entraining speeds and loads."""
        from raceway.core.contact.film import film

        speed, load = pairs.entraining_speed, pairs.load
        assert speed is not None and load is not None, "contacts at the running speed have them"
        height = film(
            self.dynamic_viscosity * speed, self.alpha, 2.0 * pairs.contact_modulus, pairs.radius_along, pairs.radius_across,
            load, pairs.ellipticity,
        )  # fmt: skip
        share = self.film_share(pairs)
        return attrs.evolve(height, central=share * height.central, minimum=share * height.minimum)


@attrs.frozen
class Lubricant(Oil):
    """The oil of all that a bearing's lubricant decides: films, friction, life, heat."""

    traction_limit: float = option(
        0.05, help="largest traction coefficient; 0.05 mineral, 0.04 synthetic oils (SKF)", rule=between(0.0, 0.3)
    )
    eyring_stress: float = option(5e6, unit="Pa", help="onset of shear thinning", rule=positive())
    oil_fraction: float | str = option(
        "auto",
        help="share of oil in the space around the balls, 0: dry air, 1: flooded; 'auto': from the flow in [heat], else 0.01",
        rule=word_or(between(0.0, 1.0), "auto"),
    )
    drag_coefficient: float = option(
        0.25, help="of a ball in oil and air; 0.44: free sphere; 0.25: with Harris's power 1.95 of speed", rule=at_least(0.0)
    )

    @classmethod
    def of(cls, oil: Oil) -> Lubricant:
        """The lubricant of an oil; its other keys have their defaults."""
        return with_values(cls(), **_oil_of(oil))

    def around_balls(self, oil_fraction: Number) -> Lubrication:
        """As friction sees it; ``oil_fraction`` : where the key says 'auto', broadcast to (n, 1, Z)."""
        from raceway.core.quantities.rolling_friction import Lubrication

        coefficients = self.dynamic_viscosity, self.alpha, self.beta, self.conductivity, self.density
        fraction = oil_fraction if isinstance(self.oil_fraction, str) else self.oil_fraction
        return Lubrication(*coefficients, self.traction_limit, self.eyring_stress, fraction, self.drag_coefficient)


def lubricated(contact: T, lubricant: Lubricant | None) -> tuple[T, Lubricant | None]:
    """The table [contact], its law with the lubricant's oil where it has none of its own; the lubricant, or that of the law's oil."""
    law = contact.law
    if not isinstance(law, Oil):
        return contact, lubricant
    if lubricant is None:
        return contact, Lubricant.of(law)
    return with_values(contact, law=with_values(law, **_oil_of(lubricant))), lubricant


def lubricant_mistakes(law: object, lubricant: Lubricant | None) -> list[Mistake]:
    """No oil, or more than one."""
    if lubricant is not None and not lubricant.known:
        return [Mistake("lubricant", None, f"no viscosity is given: {_WAYS}")]
    if not isinstance(law, Oil):
        return []
    keys = [f"contact.{key.name}" for key in attrs.fields(Oil) if getattr(law, key.name) != key.default]
    if lubricant is not None and keys:
        return [Mistake("lubricant", None, f"the oil is given twice: delete [lubricant], or {', '.join(keys)}")]
    return [] if lubricant is not None or law.known else [Mistake("contact", None, f"no viscosity is given: {_WAYS}")]


def _oil_of(oil: Oil) -> dict[str, Number]:
    return {field.name: getattr(oil, field.name) for field in attrs.fields(Oil)}
