"""``raceway study rig``: the rig's signals at every speed and load, read by the article's procedure and by the beam's inversion; its page."""

from __future__ import annotations

from cmath import exp
from collections.abc import Callable, Iterator, Sequence
from math import pi, radians
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig, rig_of
from raceway_rotor.shaft import Bearing, State, balance, bearing, rotor

from raceway import Answer, BeyondPlanError, ConvergenceError, RacewayError, Scene, __version__
from raceway.extend import (
    K_ERROR, C, Fact, Item, K, Line, Page, Part, Plot, ReadTables, Registry, Tables, Words, Workload, draw_panels, label_axes, local, new_figure,
    registry_with, row_key, rows_table, run_times, save_figure, stored_rows, without_nan, work_through, written,
)  # fmt: skip
from raceway_measure.fit.identified import Identified
from raceway_measure.fit.identify import identify_recording
from raceway_measure.fit.picture import figures
from raceway_measure.fit.shaft_angle import rotation_of
from raceway_measure.fit.signals import Recording, write_recording
from raceway_measure.fit.synchronous import slow_roll
from raceway_measure.rig.signals import (
    Cause, Reading, amplitude, critical_speed, readings, record, response, slow_roll_record, split, white_noise,
)  # fmt: skip

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_OnProgress = Callable[[str, int, int], None]

#: Runs of the bearing until it moves as the shaft does, and time of the signals of a point [s].
_RUNS, _SIGNALS_S = 6, 0.25


@attrs.frozen(eq=False)
class _Point:
    """One speed under one axial load."""

    axial: float
    state: State  # what the bearing truly does
    unbalance_force: float  # of the whole rotor [N]
    #: signals, slow : the records
    signals: Recording
    slow: Recording
    identified: Identified  # what is identified from them
    readings: list[Reading]  # by the article's procedure, on the same signals
    causes: list[Cause]  # errors of the readings, a cause at a time, by ``split``

    @property
    def name(self) -> str:
        return f"{self.state.speed * 30.0 / pi:.0f}rpm-{self.axial:.0f}N"

    @property
    def place(self) -> str:
        """Speed and load, without a line's end between number and unit."""
        return f"{self.state.speed * 30.0 / pi:.0f}\u00a0r/min, {self.axial:.0f}\u00a0N"

    @property
    def cells(self) -> dict[str, str]:
        """Of a table: what the bearing does, and K as it is identified."""
        state, found = self.state, self.identified
        return {
            "point": self.place,
            "force N": f"{abs(state.force):.4g}",
            "over m e w²/2": f"{2.0 * abs(state.force) / self.unbalance_force:.4g}",
            "bearing µm": f"{1e6 * abs(state.deflection):.4g}",
            "sensor µm": f"{1e6 * abs(state.sensor):.4g}",
            "true K N/µm": f"{1e-6 * state.stiffness:.3f}",
            "identified": f"{1e-6 * found.equivalent_stiffness:.3f}",
            "±": f"{1e-6 * found.equivalent_stiffness_error:.3f}",
            "off %": f"{100 * (found.state.stiffness / state.stiffness - 1.0):.3f}",
        }

    def to_dict(self) -> Tables:
        state, true, identification = self.state, self.state.stiffness, self.identified.content()
        return {
            "speed_rpm": state.speed * 30.0 / pi,
            "axial_n": self.axial,
            "true": {
                K.name: true,
                C.name: state.damping,
                **dict(zip(("tilt_locked_stiffness", "tilt_locked_damping"), state.locked, strict=True)),
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
                **identification,
                "error": self.identified.state.stiffness / true - 1.0,
                "relative_uncertainty": K_ERROR.of(identification) / true,
            },
            "split": [attrs.asdict(cause) for cause in self.causes],
        }


@attrs.frozen(eq=False, repr=False, slots=False)
class _RigStudy(Answer):
    """All points, with the rig and its critical speeds [r/min] by axial load."""

    stem: ClassVar[str] = "rig"

    title: str
    scene: Scene
    rig: Rig
    critical: dict[str, float]
    points: list[_Point]
    failed: list[Tables]  # points without a motion, and why
    fault: RacewayError | None = None  # why points could not be stored
    signals: bool = True  # whether ``save`` writes the records

    @property
    def passed(self) -> bool:
        return not self.failed

    def failure(self) -> RacewayError | None:
        return self.fault

    def to_dict(self) -> Tables:
        """Everything but the signals, as plain tables for JSON."""
        return without_nan({
            "title": self.title,
            "scene": self.scene.to_dict(),
            "rig": {**attrs.asdict(self.rig), "mass_kg": self.rig.mass, "disc_mass_kg": self.rig.disc_mass},
            "critical_speed_rpm": self.critical,
            "rows": [point.to_dict() for point in self.points],
            **{name: getattr(self, name) for name in ("failed", "worst", "worst_by_cause")},
        })  # fmt: skip

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

    def save(self, folder: str | Path, pictures: bool | str = False) -> list[Path]:
        """Write rig.json, the page with its figures where ``pictures`` asks for them, and the records as CSV files.

        RacewayError: a folder that cannot be written, or matplotlib is missing.
        """
        folder, files = Path(folder), super().save(folder)
        files += _write_page(self, folder) if pictures else []
        for point in self.points if self.signals else ():
            for name, recording in (("signals", point.signals), ("slow-roll", point.slow)):
                files.append(write_recording(recording, folder / f"{name}-{point.name}.csv"))
        return files

    def _facts(self) -> tuple[str, list[Fact]]:
        facts: list[Fact] = [
            (p.name, f"{1e-6 * p.state.stiffness:.4g} N/µm", f"true K; identified {1e-6 * p.identified.state.stiffness:.4g}")
            for p in self.points
        ]
        return self.title, facts + [("failed", "", _failure_words(point)) for point in self.failed]

    def report(self) -> Iterator[Part]:
        """A row for each speed and load: the true bearing, the beam inverted, the article's procedure; errors by their causes."""
        rows, worst = [], self.worst
        for point in self.points:
            ratios = {reading.correction: reading.stiffness / point.state.stiffness for reading in point.readings}
            cells = {k: cell for k, cell in point.cells.items() if k not in ("force N", "over m e w²/2", "sensor µm")}
            rows.append(cells | {words: f"{ratios[name]:.3f}" for name, words in _SHOWN.items()})
        speeds = ", ".join(f"{value:.0f} r/min on {name}" for name, value in self.critical.items())
        yield Words(self.title, "bold")
        yield Words(f"first critical speed {speeds}", "dim")
        yield rows
        yield "bearing: its own motion; identified: by the inverted beam, ± at 95 %; printed, derived: K by such a correction over the true K"
        yield f"inverted beam: at most {100 * worst['clean']:.2g} % off without noise, {100 * worst['disturbed']:.2g} % with all"
        causes = [
            {"cause": cause["kind"], "what": cause["what"], "error %": f"{100 * cause['error']:+.3g}"}
            for cause in self.worst_by_cause
        ]
        yield rows_table(causes, "Largest error of K by one cause at a time")
        yield from (Words(f"failed: {_failure_words(point)}", "red") for point in self.failed)


#: Corrections of the article's kind that the screen shows; all of them are in rig.json.
_SHOWN = {"as printed": "printed", "simply supported beam, amplified bow and force": "derived"}


def _failure_words(point: ReadTables) -> str:
    return f"{point['speed_rpm']:.0f} r/min, {point['axial_n']:.0f} N: {point['reason']}"


def rig(
    scene: Scene,
    signals: bool = True,
    *,
    plan: bool = False,
    kept: Path | None = None,
    plugins: Sequence[Path] = (),
    progress: _OnProgress | None = None,
) -> _RigStudy | Workload:
    """Simulate a test rig, the table [rig] of SCENE: a shaft with a disc on two of its bearings, and a sensor beside one.

    The signals are read by the article's procedure as printed and by inverting the beam; the error is split into its causes.
    Writes rig.json, rig.html, figures and the signals, which `raceway fit` reads. Exit code 1 when a point has no motion.
    Finished points are stored in DIR/points.sqlite and reused.

    Parameters
    ----------
    scene : with a table [rig];  plugins : files of one-off plug-ins that it uses
    signals : write the signals as CSV (default);  plan : print how many points and how long, and stop
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
    grid = enumerate((axial, rpm) for axial in inputs.axial_loads for rpm in inputs.speeds_rpm)
    about = ["rig", attrs.asdict(inputs)]
    items = [Item(row_key(scene, registry, [*about, *p, k]), f"{p[1]:.0f} r/min, {p[0]:.0f} N", (k, p)) for k, p in grid]
    if plan:
        count, stored_count = len(items), stored_rows(kept, [item.key for item in items])
        seconds, _ = run_times(_RUNS * (count - stored_count), lambda _: scene, planned=1)
        seconds, why = seconds + _SIGNALS_S * count, f"about {_RUNS} of each point"
        return Workload(scene.title, count, seconds, runs=count - stored_count, stored=stored_count, why_runs=why)
    bearings = {axial: bearing(scene, axial, registry) for axial in inputs.axial_loads}
    supports = {"rigid supports": None, **{f"bearings under {axial:g} N": specimen for axial, specimen in bearings.items()}}
    critical = {name: critical_speed(inputs, specimen) * 30.0 / pi for name, specimen in supports.items()}
    points = dict[int, _Point]()

    def compute(item: tuple[int, tuple[float, float]], _registry: Registry) -> Tables:
        """The bearing's answers: nearly all of the time; signals, and what is read from them, follow again from those."""
        k, (axial, rpm) = item
        specimen = bearings[axial].anew()
        try:
            points[k] = _point(inputs, specimen, rpm, k)
        except (ConvergenceError, BeyondPlanError) as why:
            return {"answers": [], "reason": str(why)}
        return {"answers": specimen.answers, "reason": ""}

    with written(kept) as store:
        rows, _ = work_through(compute, items, store, local(registry, 0), registry, on_progress=progress)
    if all(row["reason"] for row in rows):
        raise ConvergenceError(rows[-1]["reason"])
    failures = list[Tables]()
    for (k, (axial, rpm)), row in zip((item.task for item in items), rows, strict=True):
        if row["reason"]:
            failures.append({"speed_rpm": rpm, "axial_n": axial, "reason": row["reason"]})
        elif k not in points:
            points[k] = _point(inputs, bearings[axial].anew(row["answers"]), rpm, k)
    ordering = [points[k] for k in sorted(points)]
    return _RigStudy(scene.title, scene, inputs, critical, ordering, failures, store.fault, signals)


def _point(rig: Rig, specimen: Bearing, rpm: float, number: int) -> _Point:
    """One speed: the true motion, its signals with noise of their ``number``, and what is read from them."""
    free, seed = rotor(rig, rpm * pi / 30.0), rig.signals.seed + 2 * number
    state = balance(free, specimen)
    answer = response(rig, specimen, state, rig.signals)
    signals = record(rig, answer, rig.signals, seed)
    slow = slow_roll_record(rig, specimen, rig.signals, seed + 1, white_noise(answer, rig.signals))
    identification = identify_recording(signals, rig, specimen, slow_roll(slow))
    component = amplitude(rotation_of(signals)) * exp(-1j * radians(rig.unbalance_angle_deg))
    by_article = readings(rig, specimen, state.speed, component)
    causes = split(rig, specimen, state)
    return _Point(specimen.scene.load.axial, state, free.unbalance_force, signals, slow, identification, by_article, causes)


_KINDS = {"none": "#2a8f5b", "correction": "#c8501e", "noise": "#0b5fa5", "window": "#8a4fa3", "run-out": "#b58a00", "model": "#555f6b"}  # fmt: skip
#: Errors below this are drawn at the edge.
_LEAST_PERCENT = 1e-4


def _procedures(study: _RigStudy) -> Figure:
    """True K over speed, and what each correction makes of it."""
    panels = []
    for axial in dict.fromkeys(point.axial for point in study.points):
        points = [point for point in study.points if point.axial == axial]
        speeds = 30.0 / np.pi * np.array([point.state.speed for point in points])
        names = {points[0].readings[k].correction: k for k in (0, 3, 5)}
        numbers = {"beam inverted": [p.identified.state.stiffness for p in points]}
        numbers |= {name: [p.readings[k].stiffness for p in points] for name, k in names.items()}
        true = Line(speeds, 1e-6 * np.array([p.state.stiffness for p in points]), "true")
        lines = [Line(speeds, 1e-6 * np.array(k), {"none": "no correction"}.get(name, name), place, base=true)
                 for place, (name, k) in enumerate(numbers.items(), start=1)]  # fmt: skip
        panels.append(Plot((true, *lines), "speed [r/min]", "K [N/µm]", f"{axial:g} N axial"))
    return draw_panels([panels], "K from the rig's record, and what it differs from the true one by")


def _causes(study: _RigStudy) -> Figure:
    """Error of K by one cause at a time: a dot for each speed and load, on a logarithmic scale."""
    names = list(dict.fromkeys((cause.kind, cause.what) for point in study.points for cause in point.causes))
    figure = new_figure(8.0, 0.38 * len(names) + 1.1)
    axes: Axes = figure.subplots()
    for row, name in enumerate(reversed(names)):
        errors = [100.0 * abs(c.error) for p in study.points for c in p.causes if (c.kind, c.what) == name]
        sizes = np.maximum(errors, _LEAST_PERCENT)
        axes.plot(sizes, np.full(len(sizes), row), "o", color=_KINDS[name[0]], markersize=5, alpha=0.75)
    words = [fill(f"{kind}: {text}" if kind != "none" else text, 42) for kind, text in reversed(names)]
    axes.set_yticks(range(len(names)), words)
    axes.set_xscale("log")
    largest = 100.0 * max(abs(cause.error) for point in study.points for cause in point.causes)
    axes.set_xlim(0.8 * _LEAST_PERCENT, max(200.0, 1.5 * largest))
    for limit in (1.0, 3.0):
        axes.axvline(limit, color="#1c2733", linewidth=0.8, linestyle="--")
        axes.annotate(
            f"{limit:g} %", (limit, 1.0), (0, 2), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", va="bottom", fontsize=8,
        )  # fmt: skip
    label_axes(axes, "", "error of K alone [%]", "", 9.0)
    return figure


def _write_page(study: _RigStudy, folder: Path) -> list[Path]:
    """rig.html and its figures as PNG; RacewayError without matplotlib, or where they cannot be written."""
    first = study.points[0].identified
    record = figures(first.rotation, first.component, first.state)
    drawings = {"procedures": _procedures(study), **record, "error-split": _causes(study)}
    files = [save_figure(figure, folder / f"{name}.png") for name, figure in drawings.items()]
    # Words, tables and figures.
    points, worst, rig, signals = study.points, study.worst, study.rig, study.rig.signals
    words = (
        f"Shaft {1e3 * rig.shaft_length:g} mm long, {1e3 * rig.shaft_diameter:g} mm thick, disc of {rig.disc_mass:.3g} kg, bearings "
        f"{1e3 * rig.span:g} mm apart, {1e3 * rig.unbalance_mass:g} g at {1e3 * rig.unbalance_radius:g} mm; sensor "
        f"{1e3 * rig.sensor_distance:g} mm {rig.sensor_side} the tested bearing"
    )
    footer = f"Raceway {__version__}, study rig"
    out = Page(f"Identification of a bearing from a sensor beside it: {study.title}", words, footer)
    out.section("Result")
    out.text(
        f"Inversion of the beam identifies K within {100 * worst['clean']:.2g} % from clean signals, and within "
        f"{100 * worst['disturbed']:.2g} % with noise of {signals.noise_db:g} dB, {1e6 * signals.drift:g} µm of drift and "
        f"{1e6 * signals.run_out:g} µm of run-out, less what a slow roll shows.",
        kind="lead",
    )
    caption = "The tested bearing in the rig, and K as it is identified; ±: its uncertainty at 95 %"
    out.rows([point.cells for point in points], caption)
    alternative = "K over speed for each axial load, true and by each procedure"
    out.figures([(drawings["procedures"], alternative, "K by each procedure")])
    for point in study.failed:
        out.text(f"Failed: {_failure_words(point)}", kind="note")
    out.section("The article's procedure")
    out.text(
        "Detrend, denoise, whole-turn Fourier transform, F = m e w²/2, less the shaft's deflection as printed, "
        "m e w² a (3 L² - 16 a²) / (192 E I), over 1 - r². The run-out stays in, as the article subtracts none. A simply supported "
        "beam bends by m e w² a (3 L² - 4 a²) / (48 E I), which is the printed formula for an L of twice the span; the bearing's "
        "force is amplified, too, because the bow moves the disc outwards."
    )
    names, true = [point.place for point in points], [point.state.stiffness for point in points]
    lines = [
        [of[0].correction, *(f"{reading.stiffness / k:.3f}" for reading, k in zip(of, true, strict=True))]
        for of in zip(*(point.readings for point in points), strict=True)
    ]
    out.table(["correction", *names], lines, "K over the true K, by the correction for the shaft")
    out.section("Signals")
    out.figures([
        (drawings["signals"], "gaps along y and z over four turns, and their drift", f"The sensor at {study.points[0].name}"),
        (drawings["spectrum"], "amplitude over orders, one peak at 1x forward", "Spectrum over orders"),
        (drawings["orbits"], "orbits as circles: sensor, bow, bearing", "Orbits: most of the sensor signal is the bow of the shaft"),
    ])  # fmt: skip
    out.section("Where the error comes from")
    out.text("One cause at a time is switched on. Dashed: 1 % and 3 %; a dot for each speed and load.")
    alternative = "dots of error for each cause on a logarithmic scale"
    out.figures([(drawings["error-split"], alternative, "Error of K by its causes")], wide=True)
    causes = zip(*(point.causes for point in points), strict=True)
    lines = [[f"{of[0].kind}: {of[0].what}", *(f"{100 * cause.error:.3g}" for cause in of)] for of in causes]
    out.table(["cause", *names], lines, "Error of K [%] by one cause at a time")
    out.section("What is assumed")
    out.listing(_ASSUMED)
    return [out.write(folder / "rig.html"), *files]


_ASSUMED = [
    "Both bearings carry the same load and are mirror images about the disc; supports are rigid, coupling and weight are neglected.",
    "The shaft is a Timoshenko beam with rotary inertia and gyroscopic moments; the disc is rigid and does not stiffen it beyond `hub_diameter`.",
    "The bearing is the scene's, nonlinear: force and moment of the shaft are iterated until shaft and bearing motions "
    "agree. Motion at other orders than 1x is left out of the signals.",
    "The inversion takes the bearing's tilt under the identified force from the scene; its deflection is the signal's.",
]
