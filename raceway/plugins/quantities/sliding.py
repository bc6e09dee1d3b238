"""Whether the balls of a bearing roll: the traction that they need, beside what the contacts offer."""

from collections.abc import Mapping
from typing import ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.shown import Fact, number
from raceway.plugins.quantities.friction import ball_contacts
from raceway.storage.tables import ReadTables, Tables

#: Traction coefficient of balls where no oil is given, below the 0.08 that conventional lubricants reach.
_SUFFICIENT = 0.06


@attrs.frozen
class Sliding:
    """Whether balls roll: the traction coefficient that they need, and how hard a row is pressed together.

    Across the running direction the gyroscopic moment M takes 2 M / D of the traction mu (Q_i + Q_o) of both contacts, M under control of
    the outer race as in motions; along it the inner contacts of a row drive what rolling, drag and slip at the outer race cost, where a
    scene has an oil.  Spin takes none: its slip turns about the contact's centre.  Rows with an unloaded ball are not judged.

    References
    ----------
    A Brief Examination of Factors Affecting Tractive Friction Coefficients of Spheres Rolling on Flat Plates, ASLE Annual Meeting, Buffalo,
    April 1959 (abstract): up to 0.08.  Hirano, ASLE Trans. 8 (1965) 425: little slip above an axial force of 10 Z F_c.
    """

    name: ClassVar[str] = "sliding"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        Quantity(
            "traction_needed", "1", "traction coefficient with which all balls roll", "sliding.traction_needed", symbol="mu"
        ),
        Quantity(
            "axial_over_centrifugal", "1", "least axial force of a row over its balls' centrifugal force, F_a / (Z F_c)",
            "sliding.axial_over_centrifugal",
        ),
    )  # fmt: skip

    def why_not(self, problem: Problem) -> str:
        if problem.traits.line_contacts or not problem.kinematics.ball_inertia:
            return "sliding is that of balls with inertia"
        return ""

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        balls, speed, problem = ball_contacts(points), points.speed[:, None], points.problem
        angle = np.where(np.isfinite(balls.angle), balls.angle, balls.angle[:, ::-1])
        (inner, outer), (q_i, q_o) = np.abs(angle).swapaxes(0, 1), points.load.swapaxes(0, 1)
        diameter, pitch, inertia = (np.asarray(v)[:, 0] for v in (balls.ball_diameter, balls.pitch_diameter, balls.inertia))
        ratio = diameter / pitch
        cage = 0.5 * speed * (1.0 - ratio * np.cos(0.5 * (inner + outer)))
        moment = (
            inertia * speed * cage * np.sin(outer) * (1.0 - ratio * np.cos(inner)) / ratio / (1.0 + np.cos(inner - outer))
        )
        across = 2.0 * moment / diameter / np.maximum(q_i + q_o, 1e-300)
        driven = problem.quantities.friction.losses(points) if problem.lubricant is not None else None
        needed, pressed = [], []
        for k in range(points.row.max() + 1):
            row = points.row == k
            load, along = q_i[:, row].sum(axis=1), 0.0
            if driven is not None:
                cost = driven.contacts[:, :, k].sum(axis=1) - driven.sliding[:, 0, k] + driven.drag[:, k]
                along = cost / (0.5 * (pitch - diameter * np.cos(inner))[:, row]).mean(axis=1) / np.maximum(load, 1e-300)
            held = (q_i[:, row] > 0.0).all(axis=1)
            needed.append(np.where(held, np.hypot(across[:, row].max(axis=1), along), np.nan))
            force = (5.0 * inertia / diameter**2 * pitch * cage**2)[:, row].sum(axis=1)
            axial = (q_i * np.sin(inner))[:, row].sum(axis=1)
            pressed.append(np.where(held & (force > 0.0), axial / np.maximum(force, 1e-300), np.nan))
        return {"traction_needed": np.fmax.reduce(needed), "axial_over_centrifugal": np.fmin.reduce(pressed)}

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """Both numbers, the coefficient that the contacts offer, and where that is from."""
        numbers = {name: float(value[0]) if np.isfinite(value[0]) else None for name, value in values.items()}
        offered, source = _offered(points.problem)
        return {**numbers, "traction_offered": offered, "source": source}

    def warnings(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> list[str]:
        """Where the contacts offer less than balls need."""
        needed, (offered, source) = float(values["traction_needed"][0]), _offered(points.problem)
        if not needed > offered:
            return []
        return [
            f"balls slide: they need a traction coefficient of {needed:.2g}, contacts offer {offered:g}: {source}. Forces, friction and heat "
            "are those of balls that roll. Raise the preload, or use lighter balls (balls.material)"
        ]

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """Needed and offered traction."""
        if table["axial_over_centrifugal"] is None:
            return []
        ratio = f"F_a / (Z F_c) {table['axial_over_centrifugal']:.3g}"
        return [("traction needed", number(table["traction_needed"], "", 2), f"of {table['traction_offered']:g}; {ratio}")]


def _offered(problem: Problem) -> tuple[float, str]:
    """Traction coefficient of the contacts, and its source."""
    if problem.contact.friction > 0.0:
        return float(problem.contact.friction), "contact.friction"
    if problem.lubricant is not None:
        return float(problem.lubricant.traction_limit), "lubricant.traction_limit"
    return _SUFFICIENT, "steel balls in oil (up to 0.08: ASLE 1959), no oil or friction is given"
