"""``identify`` from records, in files or in memory: the record, and the slow roll or the run-out that is known."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import Registry
from raceway.scene.rig import Rig
from raceway.scene.scene import Scene
from raceway.studies.measured.identify import Found, identify
from raceway.studies.measured.orders import Order
from raceway.studies.measured.recording import recording_of
from raceway.studies.measured.run_out import given, slow_roll
from raceway.studies.measured.signals import Signals, read_signals
from raceway.studies.shaft.bearing import bearing

OnProgress = Callable[[str, int, int], None]


def from_files(
    signals: Path,
    scene: Scene,
    rig: Rig,
    registry: Registry,
    slow: Path | None = None,
    run_out: tuple[float, float] | None = None,
    on_progress: OnProgress | None = None,
) -> Found:
    """``from_signals`` of a record's file and the file of a slow roll."""
    still = None if slow is None else read_signals(slow)
    return from_signals(read_signals(signals), scene, rig, registry, still, run_out, on_progress)


def refuse_no_load(scene: Scene) -> None:
    """A bearing that nothing seats has no stiffness to compare with.

    Raises
    ------
    SceneError
        Naming the key.
    """
    if scene.load.axial <= 0.0:
        message = "must be the axial load of the measurement, greater than 0: add --set load.axial=..."
        raise SceneError.at("load.axial", scene.load.axial, message)


def roll_of(slow: Signals | None) -> Order | None:
    """The 1x line of a slow roll, if there is one.

    Raises
    ------
    SceneError
        What is wrong with it.
    """
    if slow is None:
        return None
    try:
        return slow_roll(recording_of(slow))
    except RacewayError as why:
        raise why if isinstance(why, SceneError) else SceneError.at(slow.source, None, str(why)) from None


def from_signals(
    signals: Signals,
    scene: Scene,
    rig: Rig,
    registry: Registry,
    slow: Signals | None = None,
    run_out: tuple[float, float] | None = None,
    on_progress: OnProgress | None = None,
) -> Found:
    """K and C from a record.

    Parameters
    ----------
    slow : a slow roll;  run_out : instead of it, its amplitude [m] and angle from the mark [deg]

    Raises
    ------
    SceneError
        What is wrong with a record or the scene.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.
    """

    def tell(what: str, done: int) -> None:
        if on_progress is not None:
            on_progress(what, done, 3)

    refuse_no_load(scene)
    recording = recording_of(signals)
    roll = roll_of(slow)
    tell("bearing at rest", 1)
    held = bearing(scene, scene.load.axial, registry)
    tell("identifying", 2)
    known = None if run_out is None else given(*run_out)
    try:
        return identify(recording, rig, held, known, roll)
    except RacewayError as why:
        if why.exit_code != 2 or isinstance(why, SceneError):
            raise
        raise SceneError.at(signals.source, None, str(why)) from None
