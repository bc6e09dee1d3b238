"""Film parameters of the thinnest oil film between balls and races, of any contact law in a scene that has an oil.

Film thicknesses are those of Hamrock and Dowson at the running speed and each loaded contact's load (``raceway.core.contact.film``), which
the heat of the inlets thins.  The contact law 'film' lets them stand the surfaces off; of other laws the surfaces' places know no film.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.core.columns import Number, at_rows
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.options import option, positive
from raceway.framework.shown import Fact, number
from raceway.scene.lubricant import Oil
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.core.contact.film import Film


@attrs.frozen
class FilmThickness:
    """Thinnest oil film of both races."""

    name: ClassVar[str] = "film"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        Quantity("film_central", "m", "least central film thickness of the loaded contacts", "film.central_m", symbol="h_c"),
        Quantity(
            "film_minimum", "m", "least minimum film thickness of the loaded contacts", "film.minimum_m", symbol="h_min"
        ),
    )

    @staticmethod
    def example_scene() -> Tables:
        oil = {"oil": "VG 32", "temperature_c": 50.0}
        return {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0, "radial": [200.0, 0.0]}, "lubricant": oil}

    def why_not(self, problem: Problem) -> str:
        if problem.traits.line_contacts:
            return "films of line contacts are not computed"
        if problem.lubricant is None:
            return "a film needs an oil: a table [lubricant] with `oil` and `temperature_c`, or with `viscosity`"
        return "" if problem.points or problem.spin_speed > 0.0 else "a film needs a speed: kinematics.spin_speed_rpm"

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        films = points.once("films", lambda: _films(points))
        return {"film_central": films.central.min(axis=(1, 2)), "film_minimum": films.minimum.min(axis=(1, 2))}

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """Least thicknesses, of each race its thinnest film with its ball, and what the oil is taken with."""
        from raceway.core.contact.film import REGIMES

        films, contacts, oil = points.once("films", lambda: _films(points)), points.running_contacts(), _oil(points)
        assert contacts.entraining_speed is not None, "contacts at the running speed have it"
        speeds = contacts.entraining_speed.reshape(films.minimum.shape)[0]
        share = oil.film_share(contacts).reshape(films.minimum.shape)[0]
        races = {}
        for k, race in enumerate(("inner", "outer")):
            ball = int(films.minimum[0, k].argmin())
            thickness = {"central_m": films.central[0, k, ball], "minimum_m": films.minimum[0, k, ball]}
            numbers = {**thickness, "entraining_speed_m_per_s": speeds[k, ball], "share_of_isothermal": share[k, ball]}
            regime = REGIMES[int(films.regime[0, k, ball])]
            races[race] = {"ball": ball, "regime": regime, **{name: float(number) for name, number in numbers.items()}}
        least = {"central_m": float(values["film_central"][0]), "minimum_m": float(values["film_minimum"][0])}
        taken = {"viscosity_pa_s": float(oil.dynamic_viscosity), "pressure_viscosity_per_pa": float(oil.alpha)}
        return {**least, **races, **taken}

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """The oil, and the thinnest film of each race."""
        oil = (
            f"{number(1e3 * table['viscosity_pa_s'], 'mPa s')}, {number(1e9 * table['pressure_viscosity_per_pa'], '1/GPa')}"
        )
        model = "Hamrock and Dowson, smooth surfaces; without contact.kind = 'film' it does not separate the surfaces"
        facts = [("Oil film", "", model)]
        for race in sorted(("inner", "outer"), key=lambda race: float(table[race]["minimum_m"])):
            film = table[race]
            thickness = ", ".join(f"{1e6 * film[name]:.4g}" for name in ("central_m", "minimum_m"))
            speed = f"{film['entraining_speed_m_per_s']:.5g} m/s, heat and supply leave {film['share_of_isothermal']:.2g}"
            facts.append((f"film h_c, h_min, {race}", f"{thickness} µm", f"ball {film['ball']}, {film['regime']}, {speed}"))
        facts.append(("viscosity, alpha", oil, "at the running temperature; pressure-viscosity coefficient"))
        return facts


def _oil(points: SolvedPoints) -> Oil:
    """The law's, with what it makes of the film, or that of [lubricant]."""
    law, lubricant = points.problem.contact.law, points.problem.lubricant
    assert lubricant is not None, "why_not says so"
    return law if isinstance(law, Oil) else lubricant


def _films(points: SolvedPoints) -> Film:
    """Of all contacts (n, 2, Z), infinite where a contact is open."""
    oil = at_rows(_oil(points), np.repeat(np.arange(len(points.load)), points.load[0].size))
    films, closed = oil.thickness(points.running_contacts()), points.load > 0.0
    central, minimum = (np.where(closed, film.reshape(closed.shape), np.inf) for film in (films.central, films.minimum))
    return attrs.evolve(films, central=central, minimum=minimum, regime=films.regime.reshape(closed.shape))


@attrs.frozen
class FilmParameter(FilmThickness):
    """Film parameter Lambda of the thinnest oil film."""

    name: ClassVar[str] = "film_parameter"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        Quantity(
            "film_parameter", "1", "least h_min of the loaded contacts over the roughness of both surfaces", "film_parameter.least",
            symbol="Lambda",
        ),
    )  # fmt: skip

    roughness: float | None = option(
        None, unit="m", help="rms of both surfaces together; default: contact.roughness", rule=positive()
    )

    @staticmethod
    def example_scene() -> Tables:
        return FilmThickness.example_scene() | {"quantities": {"film_parameter": {"roughness": 0.1e-6}}}

    def why_not(self, problem: Problem) -> str:
        missing = "a film parameter needs the surfaces' quantities.film_parameter.roughness"
        return super().why_not(problem) or ("" if self._roughness(problem) is not None else missing)

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        return {"film_parameter": super().compute(points)["film_minimum"] / self._roughness(points.problem)}

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """With the roughness."""
        return {"least": float(values["film_parameter"][0]), "roughness_m": float(self._roughness(points.problem))}

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        return [("film parameter Lambda", f"{table['least']:.3g}", f"least h_min over {1e6 * table['roughness_m']:.3g} µm")]

    def _roughness(self, problem: Problem) -> Number:
        return getattr(problem.contact.law, "roughness", None) if self.roughness is None else self.roughness
