"""A measured force, read from a CSV file."""

from __future__ import annotations

import csv
import math
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.options import inside, option

if TYPE_CHECKING:
    import numpy as np

#: Longest interval that is bridged, over the usual one.
_GAP = 5.0
_COLUMNS = ("Fx", "Fy", "Fz", "My", "Mz")


@attrs.frozen(kw_only=True)
class Measured:
    """Columns t [s] and any of Fx, Fy, Fz [N], My, Mz [N m], resampled to equal intervals; identify at ``speed_rpm``.

    Notes
    -----
    A record that repeats must hold whole periods: its last sample is one interval before its first one again.
    """

    name: ClassVar[str] = "measured"

    file: str = option(help="CSV file with a header line, relative to the scene file", path=True)
    speed_rpm: float = option(unit="r/min", help="speed whose 1x line is identified", rule=inside(0.0, 1e9))
    repeats: bool = option(False, help="the record is repeated for as long as the scene runs")

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
        return time[-1] - time[0] + ((time[-1] - time[0]) / (len(time) - 1) if self.repeats else 0.0)

    @property
    def amplitude_n(self) -> float:
        import numpy as np

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
        import numpy as np

        interval, values = self._uniform()
        time = interval * np.arange(len(values))
        wt = 2.0 * np.pi * self.frequency_hz * time
        basis = np.column_stack([np.ones_like(time), np.cos(wt), np.sin(wt)])
        solution, *_ = np.linalg.lstsq(basis, values[:, :3], rcond=None)
        return solution[1] - 1j * solution[2]

    def _uniform(self) -> tuple[float, np.ndarray]:
        import numpy as np

        time, columns = _read(self.file)
        grid = np.linspace(time[0], time[-1], len(time))
        values = np.zeros((len(time), 5))
        for name, column in columns.items():
            values[:, _COLUMNS.index(name)] = np.interp(grid, time, column)
        return float(grid[1] - grid[0]), values

    def parameters(self) -> np.ndarray:
        import numpy as np

        interval, values = self._uniform()
        return np.concatenate([[interval, float(self.repeats)], values.reshape(-1)])

    def kernel(self) -> Any:
        from raceway.core.excitations.samples import samples

        return samples


def _read(path: str) -> tuple[tuple[float, ...], dict[str, tuple[float, ...]]]:
    """Times and columns of a file; ``ValueError`` says what is wrong with it and where."""
    try:
        stamp = Path(path).stat()
    except OSError as why:
        raise ValueError(f"`file` = '{path}': {why.strerror or why}") from None
    return _parse(path, stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=8)
def _parse(path: str, _time: int, _size: int) -> tuple[tuple[float, ...], dict[str, tuple[float, ...]]]:
    try:
        with open(path, newline="", encoding="utf-8-sig") as stream:
            rows = list(csv.reader(stream))
    except (OSError, UnicodeDecodeError, csv.Error) as why:
        raise ValueError(f"`file` = '{path}' cannot be read as CSV: {why}") from None
    header = [word.strip() for word in rows[0]] if rows else []
    if "t" not in header or not set(header) & set(_COLUMNS):
        raise ValueError(f"`file` = '{path}': the first line must name t and some of {', '.join(_COLUMNS)}, not {header}")
    if unknown := [word for word in header if word not in (*_COLUMNS, "t")]:
        raise ValueError(f"`file` = '{path}': unknown columns {', '.join(unknown)}; known: t, {', '.join(_COLUMNS)}")
    if twice := sorted({word for word in header if header.count(word) > 1}):
        raise ValueError(f"`file` = '{path}': columns {', '.join(twice)} stand there twice")
    table: list[list[float]] = []
    for number, row in enumerate(rows[1:], start=2):
        if not row:
            continue
        try:
            values = [float(word) for word in row]
        except ValueError:
            values = []
        if len(values) != len(header) or not all(math.isfinite(v) for v in values):
            raise ValueError(f"`file` = '{path}', line {number}: {len(header)} finite numbers are needed, found {row}")
        table.append(values)
    if len(table) < 8:
        raise ValueError(f"`file` = '{path}': {len(table)} samples; at least 8 are needed")
    columns = dict(zip(header, (tuple(c) for c in zip(*table, strict=True)), strict=True))
    time = columns.pop("t")
    usual = sorted(b - a for a, b in zip(time, time[1:], strict=False))[len(time) // 2]
    for number, (before, after) in enumerate(zip(time, time[1:], strict=False), start=3):
        if after <= before:
            raise ValueError(f"`file` = '{path}', line {number}: time must grow, {after:g} s follows {before:g} s")
        if after - before > _GAP * usual:
            where = f"`file` = '{path}', line {number}: a gap of {after - before:g} s"
            raise ValueError(f"{where} where samples are usually {usual:g} s apart: cut the record there")
    return time, columns
