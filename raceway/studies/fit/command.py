"""The front of ``raceway fit``, also called ``raceway identify``: arguments as a command line has them, texts."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from pathlib import Path

from raceway.errors import SceneError
from raceway.out.progress import ShowProgress
from raceway.scene.inputs import SceneSource
from raceway.studies.fit.fit import Fitted, fit
from raceway.studies.fit.identify import Identified, identify


def fit_texts(
    data: str | Path,
    free: Iterable[str] = (),
    scene: SceneSource | None = None,
    mass: float | None = None,
    slow_roll: str | Path | None = None,
    run_out: str | None = None,
    columns: Iterable[str] = (),
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Fitted | Identified:
    """Fit numbers of a scene to measured data, or identify K and C of a bearing from the signals of its rig; intervals at 95 %.

    DATA is a CSV file: a table of measured quantities over keys of the scene (load.axial [N], K [N/µm], K error [N/µm]; errors are
    half-widths at 95 %); the signals of a rig (time_s, y_um, z_um and key, a once-per-turn probe, or speed_rpm; or as other programs
    do, Time (s), X [um], Y [um]); or, without a scene, a record of force and displacement (time_s, force_n, x_um), to which K, C and
    mass are fitted. Semicolons, tabs and decimal commas are read. With --free writes fit.json and fit.png. Without, SCENE has a table
    [rig], and K and C of its bearing are identified from the sensor beside it: identify.json. `raceway identify` is the same command.

    Parameters
    ----------
    data : a CSV file
    free : keys that are free; a search begins at the scene's numbers. Without, K and C of a rig are identified
    scene : the bearing or rig, with load and speed as in the measurement
    mass : moving mass of a record of force and displacement; else it is free
    slow_roll : signals at a low speed, whose run-out is subtracted
    run_out : the run-out itself: amplitude [µm] and angle from the mark [deg]
    columns : a column by its header: "Ch 1=K [N/µm]", "X [um]=y_um", or =ignore
    """
    free, meanings, vector = tuple(free), _meanings(columns), _vector(run_out)
    if free:
        return fit(
            data,
            scene,
            free,
            mass=mass,
            slow_roll=slow_roll,
            run_out=vector,
            columns=meanings,
            plugins=plugins,
            progress=progress,
        )
    if scene is None:
        message = "names nothing: give --free K,C,mass of a record of force and displacement, or --scene of a rig"
        raise SceneError.at("--free", None, message)
    if mass is not None:
        raise SceneError.at("--mass", mass, "belongs to --free and a record of force and displacement")
    return identify(data, scene, slow_roll=slow_roll, run_out=vector, columns=meanings, plugins=plugins, progress=progress)


def _meanings(texts: Iterable[str]) -> dict[str, str]:
    """Column header -> name from ``HEADER=NAME``; a header may have an equals sign, a name has none."""
    columns = {}
    for text in texts:
        header, sign, name = (part.strip() for part in text.rpartition("="))
        if not (sign and header and name):
            raise SceneError.at("--map", text, 'must have the form "HEADER=NAME", for instance "X [µm]=y_um"')
        columns[header] = name
    return columns


def _vector(text: str | None) -> tuple[float, float] | None:
    """Amplitude [m] and angle [deg] from ``UM,DEG``."""
    if text is None:
        return None
    try:
        amplitude, angle = (float(word) for word in text.split(","))
    except ValueError:
        amplitude, angle = float("nan"), 0.0
    if not (isfinite(amplitude) and isfinite(angle) and amplitude >= 0.0):
        raise SceneError.at(
            "--run-out", text, "must be an amplitude of at least 0 µm and an angle in deg, for instance 5.0,70"
        )
    return 1e-6 * amplitude, angle
