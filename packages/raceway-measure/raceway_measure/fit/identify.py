"""K and C of a bearing in a rig from measured signals: ``raceway.identify`` and its answer."""

from __future__ import annotations

from cmath import exp
from collections.abc import Iterable, Mapping
from math import pi, radians
from pathlib import Path
from typing import Annotated

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig, rig_of
from raceway_rotor.shaft import Bearing, Rotor, State, bearing, rotor

from raceway import ConvergenceError, door
from raceway.extend import PATH, PATHS, SceneSource, ShowProgress, as_scene, registry_with, telling, writable
from raceway_measure.fit.estimate import COVERAGE
from raceway_measure.fit.identified import TILT, Identified
from raceway_measure.fit.rig import changed_rotors, invert, refuse_no_load, with_tilt_of
from raceway_measure.fit.shaft_angle import rotation_of
from raceway_measure.fit.signals import COLUMNS, RUN_OUT, Data, Recording, faults_at, recording_of, signals_of
from raceway_measure.fit.synchronous import RunOut, Synchronous, response_of, stated_run_out, synchronous


@door
def identify(
    signals: Data,
    scene: SceneSource,
    *,
    slow_roll: Data | None = None,
    run_out: Annotated[tuple[float, float] | None, RUN_OUT] = None,
    columns: Annotated[Mapping[str, str] | None, COLUMNS] = None,
    out: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Identified:
    """Identify a bearing's K and C, with their uncertainty, from the signals of a sensor beside it.

    Parameters
    ----------
    signals : CSV file, mapping of arrays (n,), pandas.DataFrame or xarray.Dataset; columns as ``time_s``, ``y_um``, ``z_um`` and
        ``key`` (once-per-turn probe) or ``speed_rpm``, or as other programs name them, ``Time (s)``, ``X [um]``, ``Y [um]``
    scene : Scene, path, TOML text or dict of tables, with a table ``rig`` and ``load.axial`` [N] as in the measurement
    slow_roll : signals at a low speed, in any of these forms, whose run-out is subtracted
    run_out : the run-out itself: amplitude [m] and angle from the mark [deg]
    columns : header of a column -> name, ``{"X [um]": "y_um"}``; "ignore" leaves it out
    out : folder in which identify.json is written; None: nothing is written
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Identified
        ``equivalent_stiffness`` [N/m], ``equivalent_damping`` [N s/m] and their errors, half-widths at 95 %

    Raises
    ------
    SceneError
        The fault of signals or scene.  Records of one axis, and of force and displacement, are read, and refused
        with what they hold and what is missing.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> orbit = {"time_s": time, "y_um": 15.0 * np.cos(angle), "z_um": 15.0 * np.sin(angle), "speed_rpm": 12000.0 + 0.0 * time}
    >>> rig = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "integrator": {"kind": "quasi_static"}}
    >>> rig["rig"] = {}  # a shaft of 426 mm with a disc, see ``raceway dev schema``
    >>> bearing = rw.identify(orbit, rig)
    >>> round(1e-6 * bearing.equivalent_stiffness)  # K [N/um]
    84
    """
    registry = registry_with(plugins)
    read = as_scene(scene, plugins=plugins)
    rig = rig_of(read)
    refuse_no_load(read)
    folder = None if out is None else writable(Path(out))
    with telling(progress) as report:
        report("reading signals", 0, 3)
        run_out_known = stated_run_out(slow_roll, run_out, columns)
        record = signals_of(signals, columns)
        recording = recording_of(record)
        report("bearing at rest", 1, 3)
        tested = bearing(read, read.load.axial, registry)
        report("identifying", 2, 3)
        with faults_at(record.source):
            answer = identify_recording(recording, rig, tested, run_out_known)
    answer = attrs.evolve(answer, title=read.title, source=record.source)
    if folder is not None:
        answer.save(folder)
    return answer


def coefficients_of_state(state: State) -> np.ndarray:
    """K [N/m] and C [N s/m] with the rig's tilt, then with the tilt locked (4,)."""
    return np.array([state.stiffness, state.damping, *state.locked])


def standard_errors(shaft: Rotor, state: State, error: float) -> np.ndarray:
    """Standard errors of ``coefficients_of_state`` (4,) for one of the deflection at the sensor [m], real and imaginary part together.

    Z is analytic in the deflection while moment over tilt stays; half of its variance lies along each direction.
    """
    step = 1e-4 * abs(state.sensor)
    more, less = (coefficients_of_state(with_tilt_of(shaft, state, state.sensor + sign * step)) for sign in (1.0, -1.0))
    change = (more - less) / (2.0 * step)
    slopes = np.hypot(change[::2], state.speed * change[1::2])
    stiffness = slopes * error / np.sqrt(2.0)
    return np.array([stiffness[0], stiffness[0] / state.speed, stiffness[1], stiffness[1] / state.speed])


def _largest_change(state: State, neighbours: Iterable[State]) -> np.ndarray:
    """Largest change of ``coefficients_of_state`` (4,) among changed states."""
    return np.max([np.abs(coefficients_of_state(near) - coefficients_of_state(state)) for near in neighbours], axis=0)


def identify_recording(
    recording: Recording, rig: Rig, tested: Bearing, run_out: RunOut | Synchronous | None = None
) -> Identified:
    """K and C from a record.

    tested : the scene's bearing under the record's axial load
    run_out : the run-out, or the 1x component of a slow roll that shows it

    RacewayError: A record that cannot be used.
    ConvergenceError: Signals that no bearing of the scene's kind gives.
    """
    rotation = rotation_of(recording)
    component = synchronous(rotation)
    response = response_of(component, rig, tested, run_out)
    shaft = rotor(rig, component.speed)
    try:
        state = invert(shaft, tested, response.deflection)
    except ConvergenceError as why:
        raise ConvergenceError(
            f"no bearing like the scene's moves the sensor by {1e6 * abs(response.deflection):.4g} µm at {component.speed * 30 / pi:.0f} r/min "
            f"({why}). Check unbalance, sensor position and run-out"
        ) from None
    with_run_out = component.forward * exp(-1j * radians(rig.unbalance_angle_deg))
    deflection = tested.answer(state.speed, state.force, state.moment)[0]
    scene_stiffness = float((state.force / deflection).real + state.mass * state.speed**2)
    # The tilt stiffness is the scene's, no sensor sees it: how far the scene misses K is all that is known of how far it misses that,
    # which goes with the axial stiffness and follows the contact angle more.
    stiffer = 1.0 + TILT * abs(scene_stiffness / state.stiffness - 1.0)
    angles = (-component.angle_error, component.angle_error)
    parts = {
        "spread": COVERAGE * standard_errors(shaft, state, component.error),
        "slow roll": COVERAGE * standard_errors(shaft, state, response.run_out.error),
        "marks": _largest_change(
            state, [with_tilt_of(shaft, state, state.sensor + with_run_out * (exp(1j * turn) - 1.0)) for turn in angles]
        ),
        "window": _largest_change(state, [with_tilt_of(shaft, state, response.fourier)]),
        "tilt": _largest_change(state, [with_tilt_of(shaft, state, state.sensor, k) for k in (1.0 / stiffer, stiffer)]),
    }
    states = {word: with_tilt_of(other, state, state.sensor) for word, other in changed_rotors(rig, component.speed).items()}
    states["tilt stiffness of the bearing +10 %"] = with_tilt_of(shaft, state, state.sensor, 1.1)
    more = attrs.evolve(shaft, unbalance_force=1.01 * shaft.unbalance_force)
    states["unbalance +1 %"] = with_tilt_of(more, state, state.sensor)
    states["sensor's scale +1 %"] = with_tilt_of(shaft, state, 1.01 * state.sensor)
    base = with_tilt_of(shaft, state, state.sensor).stiffness
    changes: list[dict[str, float | str]] = [{"change": k, "stiffness": v.stiffness / base - 1.0} for k, v in states.items()]
    return Identified(rotation, component, response.run_out, state, scene_stiffness, parts, changes)
