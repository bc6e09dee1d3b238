"""``raceway study rig``: the rig's signals at every speed and load, read by the article's procedure and by the beam's inversion."""

from __future__ import annotations

from cmath import exp
from collections.abc import Callable, Iterator, Sequence
from math import pi, radians
from pathlib import Path
from typing import ClassVar

import attrs

from raceway.errors import BeyondPlanError, ConvergenceError, RacewayError
from raceway.framework.registry import Registry, registry_with
from raceway.framework.shown import Fact
from raceway.out.answer import Answer, Part
from raceway.out.quantities import K_ERROR, C, K
from raceway.out.table import rows_table
from raceway.out.wrapping import Words
from raceway.points.engine import Item, local, work_through
from raceway.points.store import row_key, written
from raceway.scene.reading import rig_of
from raceway.scene.scene import Scene
from raceway.scene.tables import Rig
from raceway.storage.files import without_nan
from raceway.storage.tables import ReadTables, Tables
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

_OnProgress = Callable[[str, int, int], None]


@attrs.frozen(eq=False)
class _Point:
    """One speed under one axial load.

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


@attrs.frozen(eq=False, repr=False, slots=False)
class RigStudy(Answer):
    """All points, with the rig and its critical speeds [r/min] by axial load.

    Attributes
    ----------
    failed : points without a motion, and why;  fault : why points could not be stored
    signals : whether ``save`` writes the records
    """

    stem: ClassVar[str] = "rig"

    title: str
    scene: Scene
    rig: Rig
    critical: dict[str, float]
    points: list[_Point]
    failed: list[Tables]
    fault: RacewayError | None = None
    signals: bool = True

    @property
    def passed(self) -> bool:
        return not self.failed

    def failure(self) -> RacewayError | None:
        return self.fault

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

    def save(self, folder: str | Path, pictures: bool = False) -> list[Path]:
        """Write rig.json, the page with its figures where ``pictures`` asks for them, and the records as CSV files.

        Raises
        ------
        RacewayError
            A folder that cannot be written, or matplotlib is missing.
        """
        from raceway.studies.rig.page import write_page

        folder, files = Path(folder), super().save(folder)
        files += write_page(self, folder) if pictures else []
        for point in self.points if self.signals else ():
            for name, recording in (("signals", point.signals), ("slow-roll", point.slow)):
                files.append(write_recording(recording, folder / f"{name}-{point.name}.csv"))
        return files

    def _shown(self) -> tuple[str, list[Fact]]:
        facts: list[Fact] = [
            (
                point.name,
                f"{1e-6 * point.state.stiffness:.4g} N/µm",
                f"true K; identified {1e-6 * point.identified.state.stiffness:.4g}",
            )
            for point in self.points
        ]
        return self.title, facts + [("failed", "", failure_words(point)) for point in self.failed]

    def report(self) -> Iterator[Part]:
        """A row for each speed and load: the true bearing, the beam inverted, the article's procedure; errors by their causes."""
        content, rows = self.to_dict(), []
        for row in content["rows"]:
            ratios = {reading["correction"]: reading["over_true"] for reading in row["printed"]}
            cells = {
                name: cell for name, cell in point_row(row).items() if name not in ("force N", "over m e w²/2", "sensor µm")
            }
            rows.append(cells | {words: f"{ratios[name]:.3f}" for name, words in _SHOWN.items()})
        worst = content["worst"]
        speeds = ", ".join(f"{value:.0f} r/min on {name}" for name, value in self.critical.items())
        yield Words(self.title, "bold")
        yield Words(f"first critical speed {speeds}", "dim")
        yield rows
        yield "bearing: its own motion; identified: by the inverted beam, ± at 95 %; printed, derived: K by such a correction over the true K"
        yield f"inverted beam: at most {100 * worst['clean']:.2g} % off without noise, {100 * worst['disturbed']:.2g} % with all"
        causes = [
            {"cause": cause["kind"], "what": cause["what"], "error %": f"{100 * cause['error']:+.3g}"}
            for cause in content["worst_by_cause"]
        ]
        yield rows_table(causes, "Largest error of K by one cause at a time")
        yield from (Words(f"failed: {failure_words(point)}", "red") for point in self.failed)


#: Corrections of the article's kind that the screen shows; all of them are in rig.json.
_SHOWN = {"as printed": "printed", "simply supported beam, amplified bow and force": "derived"}


def failure_words(point: ReadTables) -> str:
    return f"{point['speed_rpm']:.0f} r/min, {point['axial_n']:.0f} N: {point['reason']}"


def point_name(row: ReadTables) -> str:
    return f"{row['speed_rpm']:.0f}\u00a0r/min, {row['axial_n']:.0f}\u00a0N"  # no line ends between number and unit


def point_row(row: ReadTables) -> Tables:
    true, identified = row["true"], row["identified"]["identification"]
    return {
        "point": point_name(row),
        "force N": f"{true['force_n']:.4g}",
        "over m e w²/2": f"{true['force_over_half_unbalance']:.4g}",
        "bearing µm": f"{1e6 * true['deflection_m']:.4g}",
        "sensor µm": f"{1e6 * true['sensor_m']:.4g}",
        "true K N/µm": f"{1e-6 * true[K.name]:.3f}",
        "identified": f"{1e-6 * identified[K.name]:.3f}",
        "±": f"{1e-6 * identified[K_ERROR.name]:.3f}",
        "off %": f"{100 * row['identified']['error']:.3f}",
    }


def rig(
    scene: Scene,
    signals: bool = True,
    *,
    kept: Path | None = None,
    plugins: Sequence[Path] = (),
    progress: _OnProgress | None = None,
) -> RigStudy:
    """Simulate a test rig, the table [rig] of SCENE: a shaft with a disc on two of its bearings, and a sensor beside one.

    The signals are read by the article's procedure as printed and by inverting the beam; the error is split into its causes.
    Writes rig.json, rig.html, figures and the signals, which `raceway fit` reads. Exit code 1 when a point has no motion.
    Finished points are stored in DIR/points.sqlite and reused.

    Parameters
    ----------
    scene : with a table [rig];  plugins : files of one-off plug-ins that it uses
    signals : write the signals as CSV (default)
    kept : folder that finished points are stored in and taken from
    progress : called as ``progress(what, done, total)`` after each point; an exception stops the study

    Raises
    ------
    SceneError
        A scene that is no bearing of such a rig.
    ConvergenceError
        No point at which shaft and bearing find a common motion.
    """
    inputs, registry = rig_of(scene), registry_with(plugins)
    grid = list(enumerate((axial, rpm) for axial in inputs.axial_loads for rpm in inputs.speeds_rpm))
    bearings = {axial: bearing(scene, axial, registry) for axial in inputs.axial_loads}
    supports = {"rigid supports": None, **{f"bearings under {axial:g} N": tested for axial, tested in bearings.items()}}
    critical = {name: critical_speed(inputs, tested) * 30.0 / pi for name, tested in supports.items()}
    points = dict[int, _Point]()

    def compute(numbered: tuple[int, tuple[float, float]], _registry: Registry) -> Tables:
        """The bearing's answers: nearly all of the time; signals, and what is read from them, follow again from those."""
        k, (axial, rpm) = numbered
        tested = bearings[axial].anew()
        try:
            points[k] = _point(inputs, tested, rpm, k)
        except (ConvergenceError, BeyondPlanError) as why:
            return {"answers": [], "reason": str(why)}
        return {"answers": tested.answers, "reason": ""}

    keys = [row_key(scene, registry, ["rig", attrs.asdict(inputs), *point, k]) for k, point in grid]
    names = [f"{rpm:.0f} r/min, {axial:.0f} N" for _, (axial, rpm) in grid]
    items = [Item(*item) for item in zip(keys, names, grid, strict=True)]
    with written(kept) as store:
        rows, _ = work_through(compute, items, store, local(registry, 0), registry, on_progress=progress)
    if all(row["reason"] for row in rows):
        raise ConvergenceError(rows[-1]["reason"])
    failed = list[Tables]()
    for (k, (axial, rpm)), row in zip(grid, rows, strict=True):
        if row["reason"]:
            failed.append({"speed_rpm": rpm, "axial_n": axial, "reason": row["reason"]})
        elif k not in points:
            points[k] = _point(inputs, bearings[axial].anew(row["answers"]), rpm, k)
    solved = [points[k] for k in sorted(points)]
    return RigStudy(scene.title, scene, inputs, critical, solved, failed, store.fault, signals)


def _point(rig: Rig, tested: Bearing, rpm: float, number: int) -> _Point:
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
    return _Point(tested.scene.load.axial, state, free.unbalance_force, signals, slow, identified, by_article, causes)
