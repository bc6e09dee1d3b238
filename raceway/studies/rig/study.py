"""``raceway study rig``: the rig's signals at every speed and load, read by the article's procedure and by the beam's inversion."""

from __future__ import annotations

from cmath import exp
from collections.abc import Callable
from math import pi, radians
from pathlib import Path

import attrs

from raceway.errors import BeyondPlanError, ConvergenceError, RacewayError
from raceway.framework.registry import Registry
from raceway.out.quantities import K_ERROR, C, K
from raceway.points.engine import Item, local, work_through
from raceway.points.store import RowStore, row_key
from raceway.scene.scene import Scene
from raceway.scene.tables import Rig
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables
from raceway.studies.fit.identify import Identified, identify_recording
from raceway.studies.fit.shaft_angle import rotation_of
from raceway.studies.fit.signals import Recording, write_recording
from raceway.studies.fit.synchronous import slow_roll
from raceway.studies.rig.signals import (
    Cause,
    Reading,
    amplitude,
    critical_speed,
    readings,
    record,
    response,
    slow_roll_record,
    split,
    white_noise,
)
from raceway.studies.shaft import Bearing, State, balance, bearing, rotor

OnProgress = Callable[[str, int, int], None]


@attrs.frozen(eq=False)
class Point:
    """One speed under one axial load.

    Attributes
    ----------
    state : what the bearing truly does;  unbalance_force : of the whole rotor [N]
    signals, slow : the records;  identified : what is identified from them
    readings : by the article's procedure, on the same signals
    causes : errors of the readings, a cause at a time, by ``split``
    """

    axial: float
    state: State
    unbalance_force: float
    signals: Recording
    slow: Recording
    identified: Identified
    readings: list[Reading]
    causes: list[Cause]

    @property
    def name(self) -> str:
        return f"{self.state.speed * 30.0 / pi:.0f}rpm-{self.axial:.0f}N"

    def to_dict(self) -> Tables:
        state, true, identified = self.state, self.state.stiffness, self.identified.content()
        return {
            "speed_rpm": state.speed * 30.0 / pi,
            "axial_n": self.axial,
            "true": {
                K.name: true,
                C.name: state.damping,
                "tilt_locked_stiffness": state.locked[0],
                "tilt_locked_damping": state.locked[1],
                "force_n": abs(state.force),
                "force_over_half_unbalance": 2.0 * abs(state.force) / self.unbalance_force,
                "moment_nm": abs(state.moment),
                "deflection_m": abs(state.deflection),
                "slope_rad": abs(state.slope),
                "sensor_m": abs(state.sensor),
                "runs": state.runs,
            },
            "printed": [
                {"correction": row.correction, K.name: row.stiffness, "over_true": row.stiffness / true}
                for row in self.readings
            ],
            "identified": {
                **identified,
                "error": self.identified.state.stiffness / true - 1.0,
                "relative_uncertainty": K_ERROR.of(identified) / true,
            },
            "split": [attrs.asdict(cause) for cause in self.causes],
        }


@attrs.frozen(eq=False)
class RigStudy:
    """All points, with the rig and its critical speeds [r/min] by axial load; ``failed``: points without a motion, and
    why; ``fault``: why points could not be stored."""

    title: str
    scene: Scene
    rig: Rig
    critical: dict[str, float]
    points: list[Point]
    failed: list[Tables]
    fault: RacewayError | None = None

    def to_dict(self) -> Tables:
        """Everything but the signals, as plain tables for JSON."""
        return without_nan(
            {
                "title": self.title,
                "scene": self.scene.to_dict(),
                "rig": {**attrs.asdict(self.rig), "mass_kg": self.rig.mass, "disc_mass_kg": self.rig.disc_mass},
                "critical_speed_rpm": self.critical,
                "rows": [point.to_dict() for point in self.points],
                "failed": self.failed,
                "worst": self.worst,
                "worst_by_cause": self.worst_by_cause,
            }
        )

    @property
    def worst_by_cause(self) -> list[Tables]:
        """Of each cause alone the error of K that is largest over all points, with its sign."""
        worst: dict[tuple[str, str], float] = {}
        for point in self.points:
            for cause in point.causes:
                key = (cause.kind, cause.what)
                worst[key] = max(worst.get(key, 0.0), cause.error, key=abs)
        return [{"kind": kind, "what": what, "error": error} for (kind, what), error in worst.items()]

    @property
    def worst(self) -> dict[str, float]:
        """Largest errors of K over all points: clean signals, and signals with all that disturbs them."""
        clean = max(abs(cause.error) for point in self.points for cause in point.causes if cause.kind == "none")
        noisy = max(abs(point.identified.state.stiffness / point.state.stiffness - 1.0) for point in self.points)
        return {"clean": clean, "disturbed": noisy}

    def write_signals(self, folder: Path) -> list[Path]:
        """The records as CSV files.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        files = []
        for point in self.points:
            files.append(write_recording(point.signals, folder / f"signals-{point.name}.csv"))
            files.append(write_recording(point.slow, folder / f"slow-roll-{point.name}.csv"))
        return files


def study(
    scene: Scene, rig: Rig, registry: Registry, on_progress: OnProgress | None = None, store: Path | None = None
) -> RigStudy:
    """Simulate the rig and read its signals.

    Parameters
    ----------
    on_progress : called as ``on_progress(what, done, total)`` after each point; an exception stops the study
    store : file that finished points are stored in and taken from

    Raises
    ------
    SceneError
        A scene that is no bearing of such a rig.
    ConvergenceError
        No point at which shaft and bearing find a common motion.
    """
    grid = list(enumerate((axial, rpm) for axial in rig.axial_loads for rpm in rig.speeds_rpm))
    bearings = {axial: bearing(scene, axial, registry) for axial in rig.axial_loads}
    supports = {"rigid supports": None, **{f"bearings under {axial:g} N": tested for axial, tested in bearings.items()}}
    critical = {name: critical_speed(rig, tested) * 30.0 / pi for name, tested in supports.items()}
    points: dict[int, Point] = {}

    def compute(inputs: tuple[int, tuple[float, float]], _registry: Registry) -> Tables:
        """The bearing's answers: nearly all of the time; signals, and what is read from them, follow again from those."""
        k, (axial, rpm) = inputs
        tested = bearings[axial].anew()
        try:
            points[k] = _point(rig, tested, rpm, k)
        except (ConvergenceError, BeyondPlanError) as why:
            return {"answers": [], "reason": str(why)}
        return {"answers": tested.answers, "reason": ""}

    table, items = attrs.asdict(rig), []
    for k, (axial, rpm) in grid:
        key = row_key(scene, registry, ["rig", table, axial, rpm, k])
        items.append(Item(key, f"{rpm:.0f} r/min, {axial:.0f} N", (k, (axial, rpm))))
    finished = RowStore(store)
    rows, _ = work_through(compute, items, finished, local(registry, 0), registry, on_progress=on_progress)
    if all(row["reason"] for row in rows):
        raise ConvergenceError(rows[-1]["reason"])
    failed = []
    for (k, (axial, rpm)), row in zip(grid, rows, strict=True):
        if row["reason"]:
            failed.append({"speed_rpm": rpm, "axial_n": axial, "reason": row["reason"]})
        elif k not in points:
            points[k] = _point(rig, bearings[axial].anew(row["answers"]), rpm, k)
    ordered = [points[k] for k in sorted(points)]
    return RigStudy(scene.title, scene, rig, critical, ordered, failed, finished.fault)


def _point(rig: Rig, tested: Bearing, rpm: float, number: int) -> Point:
    """One speed: the true motion, its signals with noise of their ``number``, and what is read from them."""
    free, seed = rotor(rig, rpm * pi / 30.0), rig.signals.seed + 2 * number
    state = balance(free, tested)
    answer = response(rig, tested, state, rig.signals)
    signals = record(rig, answer, rig.signals, seed)
    slow = slow_roll_record(rig, tested, rig.signals, seed + 1, white_noise(answer, rig.signals))
    identified = identify_recording(signals, rig, tested, slow_roll(slow))
    component = amplitude(rotation_of(signals)) * exp(-1j * radians(rig.unbalance_angle_deg))
    by_article = readings(rig, tested, state.speed, component)
    causes = split(rig, tested, state)
    return Point(tested.scene.load.axial, state, free.unbalance_force, signals, slow, identified, by_article, causes)
