"""How balls roll: ball-pass frequencies of each row at the loaded contact angle, and the traction that rolling needs.

With g = D cos(a) / d_m at the loaded contact angle a, over the shaft's frequency: FTF = (1 - g) / 2 (cage), BPFO = Z (1 - g) / 2 and
BPFI = Z (1 + g) / 2 (balls over a place of the outer and of the inner race), BSF = d_m (1 - g^2) / (2 D) (turns of a ball about its own
axis).  Balls roll without slip and cos(a) is the mean over both races of all loaded balls of a row: at speed the races' angles differ.
Forces know one cage speed, that of the free contact angle (``BallBearing.cage_speed``), stated beside FTF as ``ftf_in_forces``.

Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed., chapter 10.
"""

from collections.abc import Mapping
from math import acos, cos, degrees, pi
from typing import ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.shown import Fact, number
from raceway.plugins.quantities.friction import ball_contacts
from raceway.storage.tables import ReadTables, Tables


def _over_shaft(name: str, words: str) -> Quantity:
    return Quantity(
        name, "1", f"{words}, over the shaft's frequency", f"ball_pass.{name}", symbol=name.upper(), dims=("row",)
    )


_NUMBERS = (
    _over_shaft("ftf", "turns of the cage"),
    _over_shaft("bpfo", "balls passing a point of the outer race"),
    _over_shaft("bpfi", "balls passing a point of the inner race"),
    _over_shaft("bsf", "spin of a ball about its axis"),
)


@attrs.frozen
class BallPass:
    """Frequencies of cage, balls and ball passes of each row."""

    name: ClassVar[str] = "ball_pass"
    numbers: ClassVar[tuple[Quantity, ...]] = _NUMBERS

    def why_not(self, problem: Problem) -> str:
        return ""

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        cosines, rows = points.once("cosines", lambda: _cosines(points)), points.problem.bearing.of_rows
        each = [ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, cosines[:, k]) for k, b in enumerate(rows)]
        return {number.name: np.stack([row[number.name] for row in each], axis=1) for number in self.numbers}

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """``speed_rpm``, and for each row its contact angle and frequencies, over the shaft's and in Hz where the shaft turns."""
        speed, rows = float(points.speed[0]) / (2.0 * pi), []
        for k, cosine in enumerate(points.once("cosines", lambda: _cosines(points))[0].tolist()):
            times = {name: float(value[0, k]) for name, value in values.items()}
            hertz = {f"{name}_hz": speed * number if speed else None for name, number in times.items()}
            free = points.problem.bearing.of_rows[k]
            in_forces = 0.5 * (1.0 - free.ball_diameter * cos(free.contact_angle) / free.pitch_diameter)
            rows.append({"contact_angle_deg": degrees(acos(cosine)), **times, **hertz, "ftf_in_forces": in_forces})
        return {"speed_rpm": 60.0 * speed, "rows": rows}

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """A line of each row that differs, in Hz where the shaft turns."""
        names, turning = ("ftf", "bsf", "bpfo", "bpfi"), bool(table["speed_rpm"])
        texts = []
        for row in table["rows"]:
            numbers = ", ".join(f"{name.upper()} {row[f'{name}_hz' if turning else name]:.4g}" for name in names)
            texts.append(f"{numbers} {'Hz' if turning else 'x shaft'} at {row['contact_angle_deg']:.4g} deg")
        different = dict.fromkeys(texts)
        return [("", "", f"row {texts.index(text) + 1}: {text}" if len(different) > 1 else text) for text in different]


def ball_pass(ball_count: int, ball_diameter: float, pitch_diameter: float, cosine: float | np.ndarray) -> Tables:
    """FTF, BPFO, BPFI and BSF over the shaft's frequency, of numbers or columns (n,).

    ball_diameter, pitch_diameter : [m];  cosine : of the loaded contact angle
    """
    g = ball_diameter * cosine / pitch_diameter
    cage = 0.5 * (1.0 - g)
    spin = 0.5 * pitch_diameter / ball_diameter * (1.0 - g * g)
    return {"ftf": cage, "bpfo": ball_count * cage, "bpfi": ball_count * (1.0 - cage), "bsf": spin}


def _cosines(points: SolvedPoints) -> np.ndarray:
    """(n, rows) of the mean contact angle of the balls that both races load; of the free angle in rows without any."""
    cosine, free = np.cos(0.5 * np.abs(points.contact_angle).sum(axis=1)), points.problem.bearing.of_rows
    columns = []
    for k, bearing in enumerate(free):
        of_row = cosine[:, points.row == k]
        loaded = np.isfinite(of_row)
        count = loaded.sum(axis=1)
        mean = np.where(loaded, of_row, 0.0).sum(axis=1) / np.maximum(count, 1)
        columns.append(np.where(count > 0, mean, np.cos(bearing.contact_angle)))
    return np.stack(columns, axis=1)


#: Traction coefficient of balls where no oil is given, below the 0.08 that conventional lubricants reach.
_SUFFICIENT = 0.06


@attrs.frozen
class Sliding:
    """Whether balls roll: the traction coefficient that they need, and how hard a row is pressed together.

    Across the running direction the gyroscopic moment M takes 2 M / D of the traction mu (Q_i + Q_o) of both contacts, M under control of
    the outer race as in motions; along it the inner contacts of a row drive what rolling, drag and slip at the outer race cost, where a
    scene has an oil.  Spin takes none: its slip turns about the contact's centre.  Rows with an unloaded ball are not judged.

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
