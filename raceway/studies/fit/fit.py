"""Numbers from measured data, for Python and the command line alike: ``raceway.fit``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.commands.progress import telling
from raceway.errors import RacewayError, SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry, registry_with
from raceway.scene.continuous import continuous_keys
from raceway.scene.given import as_scene
from raceway.scene.reading import rig_of
from raceway.scene.scene import Scene
from raceway.studies.fit.estimate import Estimate, estimate, free_keys
from raceway.studies.fit.fitted import Derived, Fitted, Series
from raceway.studies.fit.identification import roll_of
from raceway.studies.fit.linear import Linear, fit_lines, free_parts, lines_of
from raceway.studies.fit.rig import RigLine, refuse_across
from raceway.studies.fit.signals import Signals, over_time, read_table, recording_of, signals_of
from raceway.studies.fit.synchronous import Order, RunOut, given
from raceway.studies.fit.table import MEASURED, Observed, Predicted, observed, refuse_few

if TYPE_CHECKING:
    from raceway.commands.progress import ShowProgress


#: Words of keys by which a bearing is damped: without a free one C is the scene's, not the signals'.
_DAMPING = ("damping", "time_constant", "loss_factor")

#: Part of a record's force that a model may leave.
_LEFT = 0.1


def of_table(data: Observed, scene: Scene, names: list[str]) -> Fitted:
    """Free keys of a scene from a table.

    Raises
    ------
    SceneError, ConvergenceError
        What is wrong with table, keys or scene; no answer, or no end of the search.
    """
    free = free_keys(scene, names)
    refuse_few(sum(len(one) for one in data.values.values()), len(free), data.source)
    problem = Predicted.of(data, scene, free)
    found = estimate(problem, free, data.stated)
    fitted = problem.fitted(found.values)
    causes, left_out = problem.uncertain()
    exact = "groove conformities are taken as exact: [tolerances] of the scene says by how much they may be off"
    notes = (
        *problem.notes(),
        *left_out,
        *([] if "conformit" in " ".join([*causes, *names, *left_out, *data.keys]) else [exact]),
    )
    for cause, columns in causes.items():
        found = found.with_shifts(cause, columns)
    series = tuple(_series(data, problem, found, fitted, causes))
    return Fitted(scene.title, data.source, "table", data.stated, found, series, (), notes)


def of_rig(
    signals: Signals, scene: Scene, names: list[str], registry: Registry, known: RunOut | None, roll: Order | None
) -> Fitted:
    """Free keys of a scene from the signals of its rig.

    Parameters
    ----------
    known : run-out, or None;  roll : 1x line of a slow roll, or None

    Raises
    ------
    SceneError, ConvergenceError
        What is wrong with signals, keys or scene; no motion like the measured one, or no end of the search.
    """
    rig = rig_of(scene)
    free = free_keys(scene, names)
    refuse_across(scene, free)
    try:
        problem = RigLine.of(recording_of(signals), scene, rig, registry, free, known, roll)
        refuse_few(problem.count, len(free), signals.source)
        found = estimate(problem, free, stated=True)
    except RacewayError as why:
        if why.exit_code != 2 or isinstance(why, SceneError):
            raise
        raise SceneError.at(signals.source, None, str(why)) from None
    problem.residuals(found.values)
    state, line = problem.state, problem.line
    assert state is not None
    causes = problem.uncertain(found.values)
    for cause, (column, _, _) in causes.items():
        found = found.with_shifts(cause, column[:, None])
    halves = found.half_widths(problem.slopes, {cause: slopes[:, None] for cause, (_, slopes, _) in causes.items()})
    derived = [Derived("K", "N/m", state.stiffness, float(halves[0]))]
    if problem.found.marked and any(word in one.name for one in free for word in _DAMPING):
        derived.append(Derived("C", "N s/m", state.damping, float(halves[1])))
    parts = [("real", np.real), ("imaginary", np.imag)][: problem.count]
    seen, fitted = (line, state.sensor) if problem.found.marked else (abs(line), abs(state.sensor))
    slopes = np.array([part(problem.line_slopes) for _, part in parts])
    directly = {cause: np.array([[part(line)] for _, part in parts]) for cause, (_, _, line) in causes.items()}
    series = Series(
        f"line at the sensor ({' and '.join(name for name, _ in parts)} part)", "m", "part", "", np.arange(1.0, len(parts) + 1.0),
        np.array([part(seen) for _, part in parts]), np.array([part(fitted) for _, part in parts]),
        np.full(len(parts), found.widened * problem.errors[0]), found.half_widths(slopes, directly),
    )  # fmt: skip
    speed = problem.found.speed * 30.0 / np.pi
    title, notes = f"{scene.title}, {speed:.1f} r/min", problem.notes()
    return Fitted(title, signals.source, "rig", True, found, (series,), tuple(derived), notes)


def of_record(signals: Signals, names: list[str], mass: float | None) -> Fitted:
    """K, C and mass of a linear model from a record of force and displacement.

    Parameters
    ----------
    mass : where it is not free [kg]; None: it is free, named or not

    Raises
    ------
    SceneError
        What is wrong with the record or the names.
    ConvergenceError
        The search finds no end.
    """
    if mass is not None and mass < 0.0:
        raise SceneError.at("mass", mass, "must be at least 0 kg")
    lines = lines_of(signals)
    free = free_parts(names, lines, mass)
    refuse_few(2 * lines.force.size, len(free) + len(lines.axes), signals.source)
    found, model = fit_lines(lines, free, mass or 0.0)
    title = f"F = K x + C x' + m x'', {lines.omega[0] / 2.0 / np.pi:.4g} to {lines.omega[-1] / 2.0 / np.pi:.4g} Hz"
    words = {one.name.rstrip("yz").replace("k", "K").replace("c", "C") for one in free}
    notes = []
    if mass is None and not any("mass" in name for name in names):
        notes.append("mass was neither free nor given: it is free, too. --mass gives it; --mass 0 where nothing moves along")
    if absent := [word for word in ("K", "C") if word not in words]:
        notes.append(f"{' and '.join(absent)} {'are' if len(absent) > 1 else 'is'} not free: taken as 0")
    notes += model.remarks
    there = model.excited
    left = float(np.linalg.norm(model.rest[there]) / np.linalg.norm(lines.force[there]))
    if left > _LEFT:
        missing = " and ".join([*absent, *(["mass"] if mass is not None else [])])
        remedy = f"{f'free {missing} or ' if missing else ''}cut the record to frequencies below the next resonance"
        notes.append(f"the model leaves {100.0 * left:.2g} % of the force (root mean square): {remedy}")
    for one, value, half in zip(found.free, found.values, found.half, strict=True):
        if one.name in ("K", "mass", "kyy", "kzz") and value + half < 0.0:
            notes.append(
                f"{one.name} is negative: does the force's sign mean that of the displacement, and is the mass known?"
            )
    return Fitted(title, signals.source, "record", False, found, tuple(_spectra(model, found)), (), tuple(notes))


def _spectra(model: Linear, found: Estimate) -> list[Series]:
    """Real and imaginary part of F / x over frequency beside the model's, an axis each, at lines where there is force.

    Of two axes the force that moves the other one is taken off, and so is what beginning and end of the record add.
    """
    lines, there = model.lines, model.excited
    hz, out = lines.omega[there] / 2.0 / np.pi, []
    stiffness, slopes = model.stiffness(found.values)[there], model.slopes[there]
    for k, axis in enumerate(lines.axes):
        moved = lines.displacement[there, k]
        measured = stiffness[:, k, k] - model.rest[there, k] / moved
        error = np.sqrt(0.5 * model.variance(found.values)[there, k]) / np.abs(moved)
        for word, part in (("real", np.real), ("imaginary", np.imag)):
            name, band = f"F / x along {axis}, {word} part", found.half_widths(part(slopes[:, k, k]))
            fitted = part(stiffness[:, k, k])
            out.append(Series(name, "N/m", "frequency", "Hz", hz, part(measured), fitted, error, band))
    return out


def _series(
    data: Observed, problem: Predicted, found: Estimate, fitted: dict[str, np.ndarray], causes: dict[str, np.ndarray]
) -> list[Series]:
    key = next((path for path, numbers in data.keys.items() if np.ptp(numbers) > 0.0), None)
    count = len(next(iter(data.values.values())))
    x = data.keys[key] if key else np.arange(1.0, count + 1.0)
    band = found.half_widths(found.jacobian, causes).reshape(-1, count)
    units = {one.path: one.unit for one in continuous_keys(problem.scenes[0])}
    noise = found.widened if data.stated else (found.scatter or 0.0)
    return [
        Series(
            name, MEASURED[name], key or "measurement", units[key] if key else "", x, values, fitted[name],
            noise * data.weights[name], band[k] * data.weights[name],
        )
        for k, (name, values) in enumerate(data.values.items())
    ]  # fmt: skip


@door
def fit(
    data: Any,
    scene: Any = None,
    free: Iterable[str] | str = (),
    *,
    mass: float | None = None,
    slow_roll: Any = None,
    run_out: tuple[float, float] | None = None,
    columns: Mapping[str, str] | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Fitted:
    """Numbers of a scene from measured data, by least squares with the scene's exact derivatives.

    Parameters
    ----------
    data : CSV file, mapping of heads to arrays (n,) or pandas.DataFrame: a table of measured quantities over keys of the scene,
        ``load.axial [N], K [N/um], K error [N/um]``, errors as half-widths at 95 %; or the signals of a rig that ``identify`` reads;
        or a record of force and displacement, ``time_s, force_n, x_um``, of one axis or two
    scene : Scene, path, TOML text or dict of tables; with a table ``rig`` for signals; None for a record of force and displacement
    free : keys such as "bearing.contact_angle_deg", a search begins at the scene's numbers; of a record "K", "C", "mass"
    mass : that moves with a record's displacement, where it is known [kg]; None: it is free
    slow_roll, run_out : of a rig's signals, as ``identify`` takes them
    columns : head -> what it is taken for, or "ignore"
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Fitted
        ``found[key]`` the number, ``found.half_width(key)`` that of its interval at 95 %, ``warnings`` what the data do not determine

    Raises
    ------
    SceneError
        What is wrong with data, keys or scene.
    ConvergenceError
        The scene has no answer where the search begins, or the search finds no end.

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> found = rw.fit(data, {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, "bearing.contact_angle_deg")
    >>> found.determined, found.estimate.freedom
    (True, 2)
    """
    names = [part for word in free for part in word.split(",")]
    registry = registry_with(plugins)
    with telling(progress) as told:
        told("reading", 0, 2)
        record = signals_of(data, columns) if over_time(data, columns) else None
        if record is not None and any(name.startswith("force") for name in record.columns):
            refuse(
                scene is not None,
                "scene",
                "a record of force and displacement is fitted by a linear model, not by a scene: leave it out",
            )
            refuse(
                slow_roll is not None or run_out is not None, "slow roll", "belongs to the signals of a rig, without a force"
            )
            told("searching", 1, 2)
            return of_record(record, names, mass)
        refuse(mass is not None, "mass", "belongs to a record of force and displacement; a scene has its own")
        refuse(scene is None, "scene", "is missing: give --scene, whose answers the data are fitted by")
        read = as_scene(scene, plugins=plugins)
        if record is not None:
            roll = roll_of(None if slow_roll is None else signals_of(slow_roll, columns))
            told("searching", 1, 2)
            known = None if run_out is None else given(*run_out)
            return of_rig(record, read, names, registry, known, roll)
        refuse(
            slow_roll is not None or run_out is not None,
            "slow roll",
            "belongs to the signals of a rig over time; the data are a table",
        )
        table, source = read_table(data)
        told("searching", 1, 2)
        return of_table(observed(table, source, read, columns), read, names)


def refuse(wrong: bool, path: str, why: str) -> None:
    """``SceneError`` at an argument that does not belong to the data."""
    if wrong:
        raise SceneError.at(path, None, why)
