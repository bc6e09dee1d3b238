"""``raceway.fit``: numbers of a scene or a linear model from measured data; the front of the command, with ``raceway.identify``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Annotated

from raceway import SceneError, door
from raceway.extend import PATHS, TEXTS, SceneSource, ShowProgress, Tables, as_scene, registry_with, telling
from raceway_measure.fit.column_headers import FORCED, ORBIT, over_time
from raceway_measure.fit.fitted import Fitted
from raceway_measure.fit.identified import Identified
from raceway_measure.fit.identify import identify
from raceway_measure.fit.linear import fit_record
from raceway_measure.fit.response import FrequencyResponse, is_response, response_of
from raceway_measure.fit.rig import fit_rig
from raceway_measure.fit.signals import COLUMNS, RUN_OUT, Data, Signals, headers_of, signals_of, table_of
from raceway_measure.fit.synchronous import stated_run_out
from raceway_measure.fit.table import fit_table, measurements_in


@door
def fit(
    data: Data,
    scene: SceneSource | None = None,
    free: Annotated[Iterable[str] | str, TEXTS] = (),
    *,
    mass: float | None = None,
    slow_roll: Data | None = None,
    run_out: Annotated[tuple[float, float] | None, RUN_OUT] = None,
    columns: Annotated[Mapping[str, str] | None, COLUMNS] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Fitted:
    """Numbers of a scene from measured data, by least squares with the scene's exact derivatives.

    Parameters
    ----------
    data : CSV file, mapping of column headers to arrays (n,) or pandas.DataFrame: a table of measured quantities over keys of the scene,
        ``load.axial [N], K [N/um], K error [N/um]``, errors as half-widths at 95 %; or the signals of a rig that ``identify`` reads;
        or a record of force and displacement, ``time_s, force_n, x_um``, of one axis or two; or their frequency response, a universal
        file (UFF type 58: receptance, mobility, accelerance)
    scene : Scene, path, TOML text or dict of tables; with a table ``rig`` for signals; None for a record of force and displacement
    free : keys such as "bearing.contact_angle_deg", a search begins at the scene's numbers; of a record "K", "C", "mass"
    mass : that moves with a record's displacement, where it is known [kg]; None: it is free
    slow_roll, run_out : of a rig's signals, as ``identify`` takes them
    columns : header -> the header that is meant, perhaps with a sensitivity ("force_n*100": 100 N per V), or "ignore"
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Fitted
        ``fitted[key]`` the number, ``fitted.half_width(key)`` that of its interval at 95 %, ``warnings`` what the data do not determine

    Raises
    ------
    SceneError
        The fault of data, keys or scene.
    ConvergenceError
        The scene has no answer where the search begins, or the search does not converge.

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> fitted = rw.fit(data, {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, "bearing.contact_angle_deg")
    >>> fitted.determined, fitted.estimate.freedom
    (True, 2)
    """
    names = [part for word in free for part in word.split(",")]
    registry, linear = registry_with(plugins), scene is None and not any("." in name for name in names)
    with telling(progress) as report:
        report("reading", 0, 2)
        record: Signals | FrequencyResponse | None = None
        if isinstance(data, str | Path) and is_response(data):
            record = response_of(data, columns)
        elif linear or over_time(headers_of(data, "data"), columns):
            record = signals_of(data, columns, FORCED if linear else ORBIT)
        signals = record if isinstance(record, Signals) else None
        forced = record is not signals or signals is not None and any(name.startswith("force") for name in signals.columns)
        by_force = forced or linear
        if by_force and scene is not None:
            raise SceneError.at("scene", None, "a record of force and displacement is fitted by a linear model: omit it")
        if (slow_roll is not None or run_out is not None) and (by_force or signals is None):
            kind = "without a force" if by_force else "over time; the data are a table"
            raise SceneError.at("slow roll", None, f"belongs to the signals of a rig, {kind}")
        if mass is not None and not by_force:
            raise SceneError.at("mass", None, "belongs to a record of force and displacement; a scene has a mass")
        if record is not None and by_force:
            search = partial(fit_record, record, names, mass)
        elif scene is None:
            raise SceneError.at("scene", None, "is missing: give --scene, the model to fit")
        elif signals is not None:
            read, deduction = as_scene(scene, plugins=plugins), stated_run_out(slow_roll, run_out, columns)
            search = partial(fit_rig, signals, read, names, registry, deduction)
        else:
            read = as_scene(scene, plugins=plugins)
            table = measurements_in(*table_of(data, "data", "measurement"), read, columns)
            search = partial(fit_table, table, read, names)
        report("searching", 1, 2)
        return search()


def fit_texts(
    data: str | Path, free: Iterable[str] = (), scene: SceneSource | None = None, mass: float | None = None,
    slow_roll: str | Path | None = None, run_out: str | None = None, columns: Iterable[str] = (),
    plugins: Iterable[str | Path] = (), progress: ShowProgress = None,
) -> Fitted | Identified:  # fmt: skip
    """Fit numbers of a scene to measured data, or identify K and C of a bearing from the signals of its rig; intervals at 95 %.

    DATA is a CSV file: measured quantities over scene keys (load.axial [N], K [N/µm], K error [N/µm]: half-widths at 95 %); signals
    of a rig (time_s, y_um, z_um and key, a once-per-turn probe, or speed_rpm); or, without a scene, force and displacement (time_s,
    force_n, x_um) or their frequency response (frf.uff), for K, C and mass. Oscilloscope and LabVIEW files are read as saved. With
    --free writes fit.json and fit.png; without, identifies K and C of the bearing in the table [rig]: identify.json. `raceway
    identify` is the same command.

    Parameters
    ----------
    data : a CSV file
    free : free keys, started at the scene's values; without, K and C of a rig are identified
    scene : bearing or rig, with load and speed of the measurement
    mass : moving mass of a record of force and displacement; else it is free
    slow_roll : slow-roll signals, whose run-out is subtracted
    run_out : amplitude [µm] of the run-out and its angle from the mark [deg]
    columns : quantity of a column: "Ch 1=K [N/µm]", "X [um]=y_um", "CH1=force_n*100" (100 N per V), or =ignore
    """
    free, vector, meanings = tuple(free), None, {}
    if run_out is not None:
        try:
            amplitude, angle = (float(word) for word in run_out.split(","))
        except ValueError:
            amplitude, angle = float("nan"), 0.0
        if not (isfinite(amplitude) and isfinite(angle) and amplitude >= 0.0):
            remedy = "must be an amplitude of at least 0 µm and an angle in deg, for instance 5.0,70"
            raise SceneError.at("--run-out", run_out, remedy)
        vector = 1e-6 * amplitude, angle
    for text in columns:  # a header may have an equals sign, a name has none
        header, sign, name = (part.strip() for part in text.rpartition("="))
        if not (sign and header and name):
            raise SceneError.at("--map", text, 'must have the form "HEADER=NAME", for instance "X [µm]=y_um"')
        meanings[header] = name
    ways: Tables = {"slow_roll": slow_roll, "run_out": vector, "columns": meanings, "plugins": plugins, "progress": progress}
    if free:
        return fit(data, scene, free, mass=mass, **ways)
    if scene is None:
        message = "names nothing: give --free K,C,mass of a record of force and displacement, or --scene of a rig"
        raise SceneError.at("--free", None, message)
    if mass is not None:
        raise SceneError.at("--mass", mass, "belongs to --free and a record of force and displacement")
    return identify(data, scene, **ways)
