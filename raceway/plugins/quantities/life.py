"""Reference life of a bearing and of its rows, modified life, equivalent load and static safety.

Lives follow from the loads of all contacts, which know clearance, preload, tilts and speed: the constant ones, or, where a force
repeats itself, those over a turn of the motion, in which a load that turns with the inner ring meets its points otherwise than those of
the outer ring (``raceway.core.quantities.ratings``).  Whatever fails first ends the life: rings and rows add up.

The static safety factor is the contact load that C0 permits over the largest one, on the race where it is less; where C0 is by the
geometry, (4200 MPa / p_max)^3 of steel.

ISO/TS 16281:2008; ISO 281:2007; ISO 76:2006.
"""

from collections.abc import Mapping
from math import isfinite, lcm, pi
from typing import ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.core.quantities.ratings import (
    VISCOSITY_RATIOS,
    at_places,
    equivalent_loads,
    equivalent_loads_of_turn,
    life_factor,
    reference_viscosity,
    reliability_factor,
    ring_lives,
    set_rating,
    system_life,
)
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.options import between, option, positive
from raceway.framework.shown import Fact, number
from raceway.scene.ratings import LoadRatings
from raceway.storage.tables import ReadTables, Tables

#: Moments of a turn at least.
_MOMENTS = 20
#: Equivalent load over dynamic rating up to which ISO 281 holds.
_LARGEST_LOAD = 0.5


def _life_quantity(name: str, unit: str, words: str, label: str, symbol: str) -> Quantity:
    return Quantity(name, unit, words, f"life.{name}", symbol=symbol, label=label)


_NUMBERS = (
    _life_quantity("l10r_million_revolutions", "1e6", "reference life, reached by 90 %", "reference life L10r", "L10r"),
    _life_quantity("l10r_hours", "h", "reference life at the shaft's speed", "reference life in hours", "L10rh"),
    _life_quantity("l10mr_million_revolutions", "1e6", "modified life a_1 a_ISO L10r", "modified life Lnmr", "Lnmr"),
    _life_quantity("l10mr_hours", "h", "modified life at the shaft's speed", "modified life in hours", "Lnmrh"),
    _life_quantity("equivalent_load_n", "N", "load of the reference life, C L10r^(-1/3)", "equivalent load P", "P"),
    _life_quantity("static_safety", "1", "permitted over largest contact load", "static safety s0", "s0"),
    _life_quantity("rating_n", "N", "basic dynamic load rating of all rows together", "dynamic rating C", "C_rating"),
)


@attrs.frozen
class Life:
    """Reliability, cleanliness and lubrication of the modified life."""

    name: ClassVar[str] = "life"
    numbers: ClassVar[tuple[Quantity, ...]] = _NUMBERS

    reliability: float = option(0.9, help="share of bearings that reach the modified life", rule=between(0.9, 0.9995))
    contamination: float = option(
        0.5, help="factor e_C of ISO 281: 1 extremely clean, 0.5 normal, 0 severely contaminated", rule=between(0.0, 1.0)
    )
    viscosity_ratio: float | None = option(
        None, help="kappa: viscosity over that required by ISO 281; default: from the oil", rule=positive()
    )

    def why_not(self, problem: Problem) -> str:
        if problem.traits.line_contacts:
            return "lives of roller bearings are not computed"
        return next((ratings.missing for ratings in problem.ratings if ratings.missing), "")

    def turn_samples(self, problem: Problem) -> int:
        balls = lcm(*(bearing.ball_count for bearing in problem.bearing.of_rows))
        return balls * -(-_MOMENTS // balls)

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        rows = points.once("lives", lambda: self._rows(points))
        life = system_life(np.concatenate([row.ring_lives for row in rows], axis=-1))
        modified = reliability_factor(self.reliability) * system_life(np.stack([row.modified for row in rows], axis=-1))
        rating = set_rating(np.stack([np.broadcast_to(row.ratings.dynamic, life.shape) for row in rows]))
        with np.errstate(divide="ignore", invalid="ignore"):
            hours = 1e6 / (1800.0 / pi * points.speed)
            return {
                "l10r_million_revolutions": life,
                "l10r_hours": life * hours,
                "l10mr_million_revolutions": modified,
                "l10mr_hours": modified * hours,
                "equivalent_load_n": rating / np.cbrt(life),
                "static_safety": np.minimum.reduce([row.static_safety for row in rows]),
                "rating_n": rating,
            }

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """The numbers, None where they have no limit or are not known; origin of the ratings; the same of each row and its rings."""
        rows = points.once("lives", lambda: self._rows(points))
        why = self._why_not_modified(points, rows)
        numbers = {name: _stated(value) for name, value in values.items()}
        origin = ", ".join(dict.fromkeys(row.ratings.dynamic_from for row in rows))
        loads = "constant" if points.turn is None else "over a turn of the motion"
        set_by = {"reliability": self.reliability, "contamination": self.contamination}
        words = {"rating_from": origin, "loads": loads, **set_by, "not_modified": why}
        return {**numbers, **words, "rows": [row.table for row in rows]}

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """Lives, equivalent load and static safety of the bearing."""
        facts: list[Fact] = []
        worst = min(table["rows"], key=lambda row: row["life_factor"] or 0.0)
        by_row = {"kappa": worst["viscosity_ratio"], "a_ISO": worst["life_factor"], "e_C": table["contamination"]}
        modified = "; " + ", ".join(f"{symbol} {value:.3g}" for symbol, value in by_row.items() if value is not None)
        modified_life = ("l10mr", "modified life Lnmr", table["reliability"], modified)
        for name, words, share, by in (modified_life, ("l10r", "reference life L10r", 0.9, "")):
            turns, hours = table[f"{name}_million_revolutions"], table[f"{name}_hours"]
            if turns is not None:
                at_speed = f"{hours:.4g} h; " if hours is not None else ""
                facts.append((words, f"{turns:.4g} million", f"{at_speed}reached by {100.0 * share:g} %{by}"))
        origin = f"C = {number(table['rating_n'], 'N')}, by {table['rating_from']}"
        load, safety = number(table["equivalent_load_n"], "N"), table["static_safety"]
        both = ("load P, static s0", f"{load}, {safety:.3g}") if safety is not None else ("equivalent load P", load)
        return [*facts, (*both, origin)]

    def warnings(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> list[str]:
        sentences, share = [], float(values["equivalent_load_n"][0] / values["rating_n"][0])
        if share > _LARGEST_LOAD:
            words = f"life: the equivalent load is {share:.2g} of the dynamic rating; ISO 281 holds up to {_LARGEST_LOAD:g}"
            sentences.append(words)
        rows = points.once("lives", lambda: self._rows(points))
        if any(row.viscosity_ratio[0] < VISCOSITY_RATIOS[0] for row in rows):
            sentences.append(f"life: not modified: {self._why_not_modified(points, rows)}")
        return sentences

    def _why_not_modified(self, points: SolvedPoints, rows: "list[_Row]") -> str:
        """Of one point what is missing for the modified life; empty where it is known."""
        ratio = min(row.viscosity_ratio[0] for row in rows)
        if ratio >= VISCOSITY_RATIOS[0]:
            return ""
        if ratio > 0.0:
            return f"the viscosity ratio is {ratio:.2g}, and ISO 281 begins at {VISCOSITY_RATIOS[0]:g}"
        if points.problem.lubricant is None:
            return "no oil: [lubricant] or quantities.life.viscosity_ratio"
        return "no speed, which the required viscosity depends on"

    def _rows(self, points: SolvedPoints) -> "list[_Row]":
        rows, oil, speed = [], points.problem.lubricant, np.where(points.speed, points.speed, np.nan)
        for k, ratings in enumerate(points.problem.ratings):
            loads, most = self._loads(points, k)
            lives = ring_lives(loads, ratings.of_contacts[0])
            equivalent = ratings.dynamic * np.cbrt(1.0 / system_life(lives))
            kappa = self.viscosity_ratio  # nan where it is not known
            if kappa is None:
                kappa = np.nan if oil is None else oil.kinematic_viscosity / reference_viscosity(speed, ratings.row.pitch)
            ratio = np.broadcast_to(kappa, points.speed.shape)
            with np.errstate(divide="ignore"):
                safety = (ratings.of_contacts[1] / most).min(axis=-1)
                share = self.contamination * ratings.fatigue_load_limit / equivalent
                factor = share * ratio if np.isnan(ratio).all() else life_factor(ratio, share)
            rows.append(_Row(ratings, loads, lives, equivalent, safety, ratio, factor))
        return rows

    def _loads(self, points: SolvedPoints, row: int) -> tuple[np.ndarray, np.ndarray]:
        """Equivalent and largest loads (n, 2) of the rings at a row [N]."""
        problem, places = points.problem, np.flatnonzero(points.row == row)
        balls = slice(places[0], places[-1] + 1)  # those of a row follow each other
        if points.turn is None:
            load = points.load[..., balls]
            return equivalent_loads(load), load.max(axis=-1)
        period, moments = problem.excitation.period_s, self.turn_samples(problem)
        turn = points.turn(moments)[..., balls]
        largest = turn.max(axis=(1, 3))
        if problem.kinematics.orbiting:
            from raceway.core.contact.geometry import BallBearing

            geometry = BallBearing.of(problem.bearing.of_rows[row])
            pitches = 0.5 * (1.0 - geometry.gamma) * points.speed * period * len(places) / (2.0 * pi)
            turn = at_places(turn, pitches[:, None] * np.arange(moments) / moments)
        follows = np.abs(points.speed * period / (2.0 * pi) - 1.0) < 1e-6
        return equivalent_loads_of_turn(turn, follows), largest


@attrs.frozen(eq=False)
class _Row:
    """A row of balls: equivalent loads of its rings and their lives (n, 2), and numbers (n,)."""

    ratings: LoadRatings
    ring_loads: np.ndarray
    ring_lives: np.ndarray
    equivalent_load: np.ndarray
    static_safety: np.ndarray
    viscosity_ratio: np.ndarray
    life_factor: np.ndarray

    @property
    def life(self) -> np.ndarray:
        """L10r [million revolutions]."""
        return system_life(self.ring_lives)

    @property
    def modified(self) -> np.ndarray:
        """a_ISO L10r [million revolutions]."""
        return np.asarray(self.life_factor * self.life)

    @property
    def table(self) -> Tables:
        """Of one point."""
        ratings = self.ratings
        return {
            "l10r_million_revolutions": _stated(self.life),
            "equivalent_load_n": _stated(self.equivalent_load),
            "static_safety": _stated(self.static_safety),
            "rating_n": _stated(ratings.dynamic),
            "rating_from": ratings.dynamic_from,
            "static_rating_n": _stated(ratings.static),
            "static_rating_from": ratings.static_from,
            "fatigue_load_limit_n": _stated(ratings.fatigue_load_limit),
            "viscosity_ratio": _stated(self.viscosity_ratio),
            "life_factor": _stated(self.life_factor),
            "rings": [
                {"ring": ring, "equivalent_load_n": _stated(load), "l10_million_revolutions": _stated(life)}
                for ring, load, life in zip(("inner", "outer"), self.ring_loads.T, self.ring_lives.T, strict=True)
            ],
        }


def _stated(value: np.ndarray | float) -> float | None:
    """The number of one point, None where it is infinite or unknown."""
    number = float(np.ravel(value)[0])
    return number if isfinite(number) else None
