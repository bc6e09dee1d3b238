"""Friction torque and power loss of all rows and of each, by source, with a band.

The terms are those of ``raceway.core.quantities.rolling_friction``; seals and cage are given.  Each end of the band is the farther one of two: the terms'
own bands, relative and independent of each other, torque +- sqrt(sum (band part)^2), and what bearings measured near this size and speed leave
possible (``measured_factors``).  Palmgren's rule of thumb stands beside it (``palmgren_torque``).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.core.columns import Number
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.duties import is_foundation
from raceway.framework.options import at_least, between, option, word_or
from raceway.framework.shown import Fact, number
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.core.quantities.rolling_friction import BallContacts, Losses

#: Sources of friction, as results name them, and what they are.
PARTS = {
    "rolling": "the oil's shear in the inlets of the contacts",
    "elastic_rolling": "hysteresis of balls and races",
    "sliding": "slip by spin, by the contacts' curvature and by gyroscopic moments",
    "drag": "balls in the mixture of oil and air",
    "seals": "seals and cage, from input",
}
#: Share of the torque from which the drag of the balls is worth a warning.
_NOTED = 0.1


def _torque(name: str, words: str, path: str) -> Quantity:
    return Quantity(name, "N m", words, f"friction.{path}", label=words.partition(":")[0])


@attrs.frozen
class Friction:
    """Friction torque and power loss."""

    name: ClassVar[str] = "friction"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        _torque("torque_nm", "friction torque", "torque_nm"),
        Quantity("power_w", "W", "power lost by friction", "friction.power_w", label="power loss"),
        _torque("torque_low_nm", "friction torque, low end of its band", "band.low"),
        _torque("torque_high_nm", "friction torque, high end of its band", "band.high"),
        *(_torque(f"torque_{part}_nm", f"friction torque: {words}", f"parts.{part}") for part, words in PARTS.items()),
    )

    seal_torque: float = option(0.0, unit="N m", help="of the seals", rule=at_least(0.0))
    cage_torque: float = option(0.0, unit="N m", help="of the cage at its pockets and lands", rule=at_least(0.0))
    rolling_band: float = option(
        0.4, help="of the inlets' shear, relative: spread of published formulas", rule=between(0.0, 1.0)
    )
    elastic_band: float = option(0.5, help="of the hysteresis, relative", rule=between(0.0, 1.0))
    traction_band: float = option(0.3, help="of the traction coefficient, relative", rule=between(0.0, 1.0))
    drag_band: float = option(0.7, help="of oil fraction and drag coefficient, relative", rule=between(0.0, 1.0))
    measured_band: float | str = option(
        "auto",
        help="f: measured torques lie within 1/f to f times the computed one; 'auto': by bearings measured near this size and speed; 1: not used",
        rule=word_or(at_least(1.0), "auto"),
    )

    @staticmethod
    def example_scene() -> Tables:
        """For the conformance suite."""
        bearing, load = {"preset": "B7206C"}, {"axial": 1000.0, "radial": [200.0, 0.0]}
        return {"bearing": bearing, "load": load, "lubricant": {"oil": "VG 32", "temperature_c": 60.0}}

    def why_not(self, problem: Problem) -> str:
        if problem.traits.line_contacts:
            return "friction of rollers is not computed"
        if problem.lubricant is None:
            return "friction needs an oil: a table [lubricant] with `oil` and `temperature_c`, `viscosity_40`, `viscosity_100` and `temperature_c`, or `viscosity`"
        return ""

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        parts = _by_source(self.losses(points))
        torque = np.asarray(sum(parts.values()))
        bands = (self.rolling_band, self.elastic_band, self.traction_band, self.drag_band, 0.0)
        spread = np.sqrt(np.asarray(sum((band * part) ** 2 for band, part in zip(bands, parts.values(), strict=True))))
        named = {f"torque_{name}_nm": part for name, part in parts.items()}
        (least, most), computed = self.measured(points), torque - parts["seals"]
        low, high = np.maximum(spread, (1.0 - least) * computed), np.maximum(spread, (most - 1.0) * computed)
        ends = {"torque_low_nm": torque - low, "torque_high_nm": torque + high}
        return {"torque_nm": torque, "power_w": torque * points.speed, **ends, **named}

    def measured(self, points: SolvedPoints) -> tuple[Number, Number]:
        """Factors (n,) of the computed friction within which measured bearings lie; of rows the widest."""
        from raceway.core.quantities.rolling_friction import measured_factors

        if not isinstance(self.measured_band, str):
            return 1.0 / self.measured_band, self.measured_band
        factors = [measured_factors(b.pitch_diameter, points.speed) for b in points.problem.bearing.of_rows]
        return np.minimum.reduce([low for low, _ in factors]), np.maximum.reduce([high for _, high in factors])

    def losses(self, points: SolvedPoints) -> Losses:
        """Of every contact and ball."""
        from raceway.core.quantities.rolling_friction import losses

        oil = points.problem.lubricant
        assert oil is not None, "why_not says so"
        controlled = points.problem.kinematics.gyroscopic == "outer_race"
        seals = self.seal_torque + self.cage_torque
        return points.once(
            "losses",
            lambda: losses(ball_contacts(points), oil.around_balls(oil_fraction(points)), points.speed, seals, controlled),
        )

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """Torque, power, parts and band; the same of each row; heat by place; Palmgren's torque; oil and hypothesis."""

        lost, speed, oil = self.losses(points), float(points.speed[0]), points.problem.lubricant
        assert oil is not None, "why_not says so"
        numbers = {name: float(value[0]) for name, value in values.items()}
        rows = []
        for row in range(len(points.problem.bearing.of_rows)):
            parts = {name: float(part[0]) for name, part in _by_source(lost, slice(row, row + 1)).items() if name != "seals"}
            total = sum(parts.values())
            rows.append({"torque_nm": total, "power_w": total * speed, "parts": parts})
        inner, outer = (float(heat) for heat in lost.contact_power[0].sum(axis=1))
        places = {"inner": inner, "outer": outer, "mixture": float(lost.drag_power[0]), "seals": float(lost.seal_power[0])}
        return {
            "torque_nm": numbers["torque_nm"],
            "power_w": numbers["power_w"],
            "parts": {name: numbers[f"torque_{name}_nm"] for name in PARTS},
            "band": {"low": numbers["torque_low_nm"], "high": numbers["torque_high_nm"]},
            "rows": rows,
            "heat_w": places,
            "palmgren_nm": palmgren_torque(points),
            "viscosity_pa_s": float(oil.dynamic_viscosity),
            "spin": "outer race control" if points.problem.kinematics.gyroscopic == "outer_race" else "least dissipation",
            "gyroscopic_over_traction": float(lost.gyroscopic.max()),
        }

    def warnings(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> list[str]:
        """Of an oil fraction beyond what was measured, where drag counts."""
        return beyond_jets(points) if values["torque_drag_nm"][0] > _NOTED * values["torque_nm"][0] else []

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """Torque with its band, power, and the parts."""
        ends, parts, rule = [table["band"][end] for end in ("low", "high")], table["parts"], table["palmgren_nm"]
        torque, power, heat = table["torque_nm"], table["power_w"], table["heat_w"]
        shares = ", ".join(f"{name.replace('_', ' ')} {part:.3g}" for name, part in parts.items() if part)
        lost = [power * end / torque if power and torque and end is not None else None for end in ends]
        return [
            ("Friction", "", ""),
            ("friction torque", number(torque, "N m", 4), f"{' to '.join(number(end, '', 3) for end in ends)}; {number(power, 'W', 4)}"),
            (
                "power loss", number(power, "W", 4),
                f"{number(lost[0], '', 3)} to {number(lost[1], '', 3)}, inner {number(heat['inner'], '', 3)}, outer {number(heat['outer'], '', 3)}",
            ),
            ("torque by source", "N m", shares),
            (
                "Palmgren's rule", number(rule["oil_bath"], "N m", 3),
                f"{number(rule['oil_and_air'], '', 3)} oil and air, {number(rule['oil_jet'], '', 3)} jet",
            ),
        ]  # fmt: skip


def _by_source(lost: Losses, rows: slice = slice(None)) -> dict[str, np.ndarray]:
    """(n,) torque of each of ``PARTS``."""
    contacts = {name: getattr(lost, name)[:, :, rows].sum(axis=(1, 2)) for name in ("rolling", "elastic_rolling", "sliding")}
    return {**contacts, "drag": lost.drag[:, rows].sum(axis=1), "seals": lost.seals}


#: Volume of oil over that of the space around the balls where nothing says how much there is.
_LITTLE_OIL = 0.01

#: Palmgren's f0 of an oil bath: deep groove and angular contact; half of it for oil and air, twice for jets.
_BATH = (2.0, 3.3)

#: Palmgren's f1 at a tenth of the static rating: 0.0005 0.1^0.55 and 0.001 0.1^0.33.
_LOAD_FACTORS = (1.4e-4, 4.7e-4)


def oil_fraction(points: SolvedPoints) -> Number:
    """Of the space around each ball: by the flow where [heat] has one, else that of little oil."""
    heat, rows = points.problem.heat, points.problem.bearing.of_rows
    if heat is None or isinstance(heat.oil_flow, str):
        return _LITTLE_OIL
    from raceway.core.quantities.thermal import jet_oil_fraction

    by_row = [jet_oil_fraction(heat.oil_flow / len(rows), points.speed, b.pitch_diameter) for b in rows]
    return np.stack(by_row, axis=-1)[:, None, points.row]


def beyond_jets(points: SolvedPoints) -> list[str]:
    """Warning of an oil fraction by the flow at speeds that its correlation was not measured at."""
    heat, oil = points.problem.heat, points.problem.lubricant
    if heat is None or isinstance(heat.oil_flow, str) or oil is None or not isinstance(oil.oil_fraction, str):
        return []
    from raceway.core.quantities.thermal import JET_SPEEDS

    n_dm = float(points.speed[0]) * 30e3 / pi * max(float(row.pitch_diameter) for row in points.problem.bearing.of_rows)
    low, high = JET_SPEEDS
    if low <= n_dm <= high:
        return []
    return [
        f"drag and heat are estimates: n d_m = {1e-6 * n_dm:.2g} is outside {1e-6 * low:g} to {1e-6 * high:g} million mm r/min, the jets of "
        "lubricant.oil_fraction 'auto' (Parker 1984). Give it where it is known"
    ]


def ball_contacts(points: SolvedPoints) -> BallContacts:
    """The contacts of all rows as the core's friction sees them."""
    from raceway.core.quantities.rolling_friction import BallContacts

    rows = points.problem.bearing.of_rows

    def of_balls(numbers: list[Number]) -> np.ndarray:
        """(1 or n, 1, Z) of the numbers of the rows."""
        rows = np.empty((max(map(np.size, numbers)), len(numbers)))
        for k, of_row in enumerate(numbers):
            rows[:, k] = of_row
        return rows[:, None, points.row]

    diameter = of_balls([b.ball_diameter for b in rows])
    stiff = [2.0 / sum((1.0 - m.poisson**2) / m.young for m in (b.rings, b.balls)) for b in rows]
    races = [of_balls([getattr(b, f"conformity_{race}") for b in rows]) for race in ("inner", "outer")]
    # Ellipses of Hertz grow with the cube root of the load, those of a foundation do not.
    own = is_foundation(points.problem.contact.law)
    load = np.where(points.load > 0.0, points.load, 1.0) if own else np.ones((1, *points.load.shape[1:]))
    _, major, minor = points.ellipse(load)
    semi_axes = major / np.cbrt(load), minor / np.cbrt(load)
    sizes = diameter, of_balls([b.pitch_diameter for b in rows]), np.concatenate(np.broadcast_arrays(*races), axis=1)
    inertia = of_balls([b.balls.density for b in rows]) * pi * diameter**5 / 60.0
    return BallContacts(points.load, points.contact_angle, points.row, *semi_axes, *sizes, of_balls(stiff), inertia)


def palmgren_torque(points: SolvedPoints) -> dict[str, float]:
    """Palmgren's rule of thumb at one point [N m], by supply of oil.

    M0 = 1e-7 f0 (nu n)^(2/3) d_m^3, 160e-7 f0 d_m^3 where nu n < 2000; M1 = f1 F d_m; in N mm, mm2/s, r/min and mm.  F is the larger of
    the radial load and 0.9 F_a cot(angle) - 0.1 F_r at the nominal angle.  Of rows the sum; a radial load is shared.

    Palmgren, Ball and Roller Bearing Engineering, 3rd ed. (1959); Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed.,
    chapter 10.
    """
    oil, rows = points.problem.lubricant, points.problem.bearing.of_rows
    assert oil is not None, "why_not says so"
    rpm, nu = float(points.speed[0]) * 30.0 / pi, 1e6 * float(oil.kinematic_viscosity)
    radial = float(np.hypot(*points.problem.load.radial)) / len(rows)
    churned = carried = 0.0
    for row, b in enumerate(rows):
        balls, kind = points.row == row, int(b.contact_angle > 0.1)
        pitch = 1e3 * b.pitch_diameter
        axial = np.nansum(points.load[0, 1, balls] * np.abs(np.sin(points.contact_angle[0, 1, balls])))
        angle = max(b.contact_angle, float(np.nanmean(np.abs(points.contact_angle[0, 1, balls]))) if kind == 0 else 0.0, 0.1)
        churned += 1e-7 * _BATH[kind] * max(nu * rpm, 2000.0) ** (2.0 / 3.0) * pitch**3 if rpm > 0.0 else 0.0
        carried += _LOAD_FACTORS[kind] * max(radial, 0.9 * float(axial) / np.tan(angle) - 0.1 * radial) * pitch
    supplies = {"oil_and_air": 0.5, "oil_bath": 1.0, "oil_jet": 2.0}
    return {name: 1e-3 * (supply * churned + carried) for name, supply in supplies.items()}
