"""A measured force, read from a CSV file."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.core.deferred import deferred
from raceway.framework.options import inside, option
from raceway.storage.number_table import read_numbers

if TYPE_CHECKING:
    from raceway.core.jit import Kernel

#: Samples at least, and samples that are fitted at once.
_LEAST, _AT_ONCE = 8, 2**16
_COLUMNS = ("Fx", "Fy", "Fz", "My", "Mz")


@deferred("FORCE")
def samples(t, params, out):
    """Samples at equal intervals: out (5,), a Catmull-Rom cubic, once continuously differentiable, third order between them.

    params: interval [s], 1 if the samples repeat, then rows of F_x, F_y, F_z, M_y, M_z one after the other.

    Before the first and after the last sample of a record that does not repeat, the end values hold.
    """
    n = (params.size - 2) // 5
    position = t / params[0]
    k = int(np.floor(position))
    u = position - k
    repeat = params[1] != 0.0
    if not repeat:
        if position <= 0.0:
            k, u = 0, 0.0
        elif k >= n - 1:
            k, u = n - 2, 1.0
    w0 = 0.5 * u * (-1.0 + u * (2.0 - u))
    w1 = 1.0 + 0.5 * u * u * (-5.0 + 3.0 * u)
    w2 = 0.5 * u * (1.0 + u * (4.0 - 3.0 * u))
    w3 = 0.5 * u * u * (u - 1.0)
    for i in range(out.size):
        total = 0.0
        for j in range(4):
            row = k - 1 + j
            row = row % n if repeat else min(max(row, 0), n - 1)
            weight = w0 if j == 0 else (w1 if j == 1 else (w2 if j == 2 else w3))
            total += weight * params[2 + 5 * row + i]
        out[i] = total


@attrs.frozen(kw_only=True)
class Measured:
    """Columns t [s] and any of Fx, Fy, Fz [N], My, Mz [N m], resampled to equal intervals; identify at ``speed_rpm``.

    A record that repeats must hold whole periods: its last sample is one interval before its first one again.
    """

    name: ClassVar[str] = "measured"

    file: str = option(help="CSV file with a header line, relative to the scene file", path=True)
    speed_rpm: float = option(unit="r/min", help="speed of the synchronous (1x) component", rule=inside(0.0, 1e9))
    repeats: bool = option(False, help="repeat the record")

    def __attrs_post_init__(self) -> None:
        _read(self.file)

    @classmethod
    def examples(cls) -> list[Measured]:
        """Instances for the conformance suite: one turn of a force with a third harmonic."""
        from raceway import data

        file = str(Path(data.__path__[0]) / "forces" / "turning.csv")
        return [cls(file=file, speed_rpm=12000.0, repeats=True), cls(file=file, speed_rpm=12000.0)]

    @property
    def frequency_hz(self) -> float:
        return self.speed_rpm / 60.0

    @property
    def period_s(self) -> float | None:
        """One turn, if the record repeats after whole turns; else the force is not periodic."""
        turns = self._length / (60.0 / self.speed_rpm)
        return 60.0 / self.speed_rpm if self.repeats and abs(turns - 1.0) < 1e-6 else None

    @property
    def duration_s(self) -> float | None:
        return None if self.repeats else self._length

    @property
    def _length(self) -> float:
        time, _ = _read(self.file)
        length = float(time[-1] - time[0])
        return length + (length / (len(time) - 1) if self.repeats else 0.0)

    @property
    def amplitude_n(self) -> float:
        line = self._line()
        return float(np.linalg.svd(np.array([line.real, line.imag]), compute_uv=False)[0])

    @property
    def sense(self) -> int:
        _, y, z = self._line()
        forward, backward = abs(y + 1j * z), abs(y - 1j * z)
        if forward > 2.0 * backward:
            return 1
        return -1 if backward > 2.0 * forward else 0

    def phase(self, time: np.ndarray) -> np.ndarray:
        """Angle of the identified line (n,) [rad]."""
        return 2.0 * math.pi * self.frequency_hz * time

    def _line(self) -> np.ndarray:
        """1x phasors of F_x, F_y, F_z."""
        time, _ = _read(self.file)
        grid = np.linspace(time[0], time[-1], len(time))
        square, right = np.zeros((3, 3)), np.zeros((3, 3))
        for first in range(0, len(grid), _AT_ONCE):
            t = grid[first : first + _AT_ONCE]
            wt = 2.0 * np.pi * self.frequency_hz * (t - grid[0])
            basis = np.column_stack([np.ones_like(t), np.cos(wt), np.sin(wt)])
            square += basis.T @ basis
            right += basis.T @ self._at(t)[:, :3]
        solution, *_ = np.linalg.lstsq(square, right, rcond=None)
        return solution[1] - 1j * solution[2]

    def _at(self, t: np.ndarray) -> np.ndarray:
        """(n, 5) forces and moments at times (n,) [s]."""
        time, columns = _read(self.file)
        values = np.zeros((len(t), 5))
        for name, column in columns.items():
            values[:, _COLUMNS.index(name)] = np.interp(t, time, column)
        return values

    def parameters(self) -> np.ndarray:
        time, _ = _read(self.file)
        grid = np.linspace(time[0], time[-1], len(time))
        return np.concatenate([[grid[1] - grid[0], float(self.repeats)], self._at(grid).reshape(-1)])

    def kernel(self) -> Kernel:
        return samples()


def _read(path: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times and columns (n,) of a file; ``ValueError`` says what is wrong with it and where."""
    try:
        stamp = Path(path).stat()
        return _parse(path, stamp.st_mtime_ns, stamp.st_size)
    except OSError as why:
        raise ValueError(f"`file` = '{path}': {why.strerror or why}") from None
    except ValueError as why:
        raise ValueError(f"`file` = '{path}': {why}") from None


@lru_cache(maxsize=8)
def _parse(path: str, _time: int, _size: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    table = read_numbers(Path(path), _judge)
    if table.notes:
        raise ValueError(table.notes[0])
    if len(table.values) < _LEAST:
        raise ValueError(f"{len(table.values)} samples; at least {_LEAST} are needed")
    table.values.setflags(write=False)
    columns = dict(zip(table.header, table.values.T, strict=True))
    time = columns.pop("t")
    table.refuse_uneven(time)
    return time, columns


def _judge(header: list[str]) -> None:
    if "t" not in header or not set(header) & set(_COLUMNS):
        raise ValueError(f"the first line must name t and some of {', '.join(_COLUMNS)}, not {header}")
    # A second column of a name is called by its number as well.
    if twice := [name for name in _COLUMNS if any(f"{name} {k + 1}" == word for k, word in enumerate(header))]:
        raise ValueError(f"columns {', '.join(twice)} are duplicated")
    if unknown := [word for word in header if word not in (*_COLUMNS, "t")]:
        raise ValueError(f"unknown columns {', '.join(unknown)}; known: t, {', '.join(_COLUMNS)}")
