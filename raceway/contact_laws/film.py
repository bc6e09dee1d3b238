"""Hertz contacts that an elastohydrodynamic film keeps apart."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.contact_laws.hertz import three_halves
from raceway.framework.contracts import LawReport
from raceway.framework.options import between, one_of, option, positive
from raceway.scene.lubricant import Oil

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.jit import Kernel
    from raceway.framework.contracts import ContactPairs
    from raceway.storage.tables import Tables

#: Lambda below which surfaces carry through asperities.
_MIXED, _BOUNDARY = 3.0, 1.0
#: Thermal reduction that is reported as strong, and the thermal loading to which its formula was compared with Grubin's inlet.
_STRONG, _LOADING = 0.5, 100.0


@attrs.frozen
class Film(Oil):
    """Hertz contact behind an oil film (Hamrock and Dowson): the surfaces stand off by the central film thickness,
    which the heat of shear in the inlet reduces (Murch and Wilson).

    The thickness belongs to the running speed, the loaded contact angles and each contact's load Q0 in the equilibrium.  Its
    dependence on the load, h = h0 (Q/Q0)^-e, is linearised in the elastic approach d: h = h0 (1 + m - m d/d0), m = 1.5 e.
    The force by the gap is then again a power of 1.5, K' (reach - gap)^1.5 with reach = (1 + m) h0 and
    K' = K / (1 + m h0/d0)^1.5: exact in force and stiffness at Q0, and as quick as Hertz.
    """

    name: ClassVar[str] = "film"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    renewed: ClassVar[bool] = True
    elementwise: ClassVar[bool] = True

    inlet_heating: str = option(
        "murch_wilson", help="thins the film: by 'murch_wilson', or 'none' (isothermal)", rule=one_of("murch_wilson", "none")
    )
    starvation: float = option(1.0, help="thickness over that of a flooded contact", rule=between(0.0, 1.0))
    roughness: float | None = option(
        None, unit="m", help="rms of both surfaces together, sqrt(R1^2 + R2^2), for Lambda", rule=positive()
    )

    @classmethod
    def examples(cls) -> list[Film]:
        """Instances for the conformance suite; rules for mineral oils hold in SI units alone."""
        return [
            cls(viscosity=0.03, pressure_viscosity=2e-8, temperature_viscosity=0.03),
            cls(viscosity=0.3, pressure_viscosity=1e-8, temperature_viscosity=0.05, starvation=0.5),
        ]

    def film_share(self, pairs: ContactPairs) -> np.ndarray:
        """What heat and supply leave of a flooded, isothermal film (n,)."""
        return self.starvation * self._reduction(pairs)

    def _reduction(self, pairs: ContactPairs) -> np.ndarray:
        reduction = self.inlet(pairs)[1]
        return reduction**0 if self.inlet_heating == "none" else reduction

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
        return three_halves()

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
        words = " and ".join(sorted({REGIMES[each] for each in films.regime if each != 0}))
        doubts = [f"contacts are not in the piezoviscous-elastic regime of rolling bearings but {words}"] if words else []
        return LawReport(columns, table, (*self._heated(pairs), *doubts, *self._rough(lambdas)))

    def _heated(self, pairs: ContactPairs) -> list[str]:
        """A sentence where the heat of the inlet decides the film, from speed and viscosity."""
        loading, reduction = self.inlet(pairs)
        if reduction.min() >= _STRONG:
            return []
        speed = 0.0 if pairs.entraining_speed is None else float(pairs.entraining_speed.max())
        beyond = f", beyond the {_LOADING:g} to which the formula was checked" if loading.max() > _LOADING else ""
        leaves = "leaves"
        remedy = "Measure the oil's contact.temperature_viscosity and contact.conductivity, or use a thinner oil"
        if self.inlet_heating == "none":
            leaves, remedy = "would leave", "Include it by contact.inlet_heating = 'murch_wilson'"
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
                f"boundary lubrication: {sentence}, below {_BOUNDARY:g}: the surfaces touch, and the smooth-surface film does not carry the "
                "load. Use a thicker oil, a higher speed or smoother surfaces, or contact.kind = 'hertz'"
            ]
        return [f"mixed lubrication: {sentence}, below {_MIXED:g}: asperities carry a part"] if thinnest < _MIXED else []
