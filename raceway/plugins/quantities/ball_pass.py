"""Ball-pass frequencies of each row at the loaded contact angle.

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
from raceway.framework.shown import Fact
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
        cosines, rows = _cosines(points), points.problem.bearing.of_rows
        each = [ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, cosines[:, k]) for k, b in enumerate(rows)]
        return {number.name: np.stack([row[number.name] for row in each], axis=1) for number in self.numbers}

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """``speed_rpm``, and for each row its contact angle and frequencies, over the shaft's and in Hz where the shaft turns."""
        speed, rows = float(points.speed[0]) / (2.0 * pi), []
        for k, cosine in enumerate(_cosines(points)[0].tolist()):
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

    Parameters
    ----------
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
