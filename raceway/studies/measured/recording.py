"""A record of a rig's two sensors: what is needed of its columns, and the CSV file that the rig's study writes.

``heads`` says how columns may be named, ``signals`` what they may stand in.
"""

from __future__ import annotations

import math
from pathlib import Path

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.storage.files import write_whole
from raceway.studies.measured.heads import IGNORE
from raceway.studies.measured.signals import Signals, read_signals

#: Samples that may lie at one end of the range beyond those of a sine of the same resolution, of all.
_AT_THE_END = 0.02


@attrs.frozen(eq=False)
class Recording:
    """Samples (n,): time [s], gaps along y and z [m], voltage of the mark's probe, speed [rad/s]; the last two may be None."""

    time: np.ndarray
    y: np.ndarray
    z: np.ndarray
    key: np.ndarray | None = None
    speed: np.ndarray | None = None

    @property
    def plane(self) -> np.ndarray:
        """y + j z (n,)."""
        return self.y + 1j * self.z

    def part(self, chosen: np.ndarray) -> Recording:
        """Some of the samples."""
        key, speed = (None if v is None else v[chosen] for v in (self.key, self.speed))
        return Recording(self.time[chosen], self.y[chosen], self.z[chosen], key, speed)


def read_recording(path: Path) -> Recording:
    """A record from its CSV file.

    Raises
    ------
    SceneError
        What is wrong with the file, with the line.
    """
    return recording_of(read_signals(path))


def recording_of(signals: Signals) -> Recording:
    """The record that a bearing in a rig is identified from.

    Raises
    ------
    SceneError
        Signals that were read well and that K and C cannot be identified from: what they are, why, and what to do.
    """
    columns, source = signals.columns, signals.source
    force = [name for name in columns if name.startswith("force")]
    if force:
        raise SceneError.at(
            source, None,
            f"was read ({signals.told()}), but what excites the rig of the scene is its unbalance. A linear model's K, C and mass from force and "
            "displacement: raceway fit FILE.csv --free K,C. For the rig give a record of both displacements and the mark under the unbalance "
            f'(a force that is recorded beside them is left out with --map "HEAD={IGNORE}")',
        )  # fmt: skip
    if missing := [name for name in ("y", "z") if name not in columns]:
        raise SceneError.at(
            source, None,
            f"no column for {', '.join(missing)}. It was read ({signals.told()}), but K and C of a bearing in a rig are identified from "
            "its orbit: record y and z together, or name the column that holds the other axis with --map",
        )  # fmt: skip
    if not {"key", "speed"} & set(columns):
        raise SceneError.at(
            source, None,
            f"{signals.where}no speed: a column `key` (once-per-turn probe) or `speed_rpm` is needed; it was read ({signals.told()})",
        )  # fmt: skip
    for name in ("y", "z"):
        _refuse_clipped(source, name, columns[name])
    return Recording(columns["time"], columns["y"], columns["z"], columns.get("key"), columns.get("speed"))


def write_recording(recording: Recording, path: Path) -> Path:
    """Write a record as CSV: seconds, micrometres, the probe's voltage, r/min.

    Raises
    ------
    RacewayError
        A folder that cannot be written.
    """
    known = {
        "time_s": (recording.time, "%.9g"),
        "y_um": (recording.y * 1e6, "%.7g"),
        "z_um": (recording.z * 1e6, "%.7g"),
        "key": (recording.key, "%.6g"),
        "speed_rpm": (None if recording.speed is None else recording.speed * 30.0 / math.pi, "%.9g"),
    }
    there = {name: (values, form) for name, (values, form) in known.items() if values is not None}
    lines = [",".join(there)]
    form = ",".join(form for _, form in there.values())
    lines += [form % row for row in zip(*(values for values, _ in there.values()), strict=True)]
    return write_whole(("\n".join(lines) + "\n").encode(), path)


def _refuse_clipped(source: str, name: str, signal: np.ndarray) -> None:
    """A signal that stays at the end of its range was cut off there: its 1x line is that of another motion.

    Notes
    -----
    A sine of amplitude A in steps of q stays arccos(1 - q / A) / pi of its time within the last step at each end.  A signal
    without noise that keeps step with its samples has few values, each as often as another.
    """
    values, counts = np.unique(signal, return_counts=True)
    if len(values) < 3:
        return
    amplitude, step = 0.5 * (values[-1] - values[0]), float(np.diff(values).min())
    usual = math.acos(max(1.0 - step / amplitude, -1.0)) / math.pi
    usual = max(usual, float(np.median(counts)) / len(signal))
    for word, end in (("top", values[-1]), ("bottom", values[0])):
        there = float((signal == end).mean())
        if there > 2.0 * usual + _AT_THE_END:
            text = f"{100.0 * there:.2g} % of all samples of {name} lie at the {word} of its range, {1e6 * end:.6g} µm: the signal is cut off"
            raise SceneError.at(
                source, None, f"{text} there. Take a larger range of the sensor or of its amplifier, and record again"
            )
