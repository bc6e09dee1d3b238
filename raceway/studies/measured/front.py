"""K and C of a bearing in a rig from measured signals, for Python and the command line alike: ``raceway.identify``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from raceway.commands.progress import ShowProgress, telling
from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.pipeline.result import write_json
from raceway.scene.given import as_scene
from raceway.scene.reading import rig_of
from raceway.storage.files import writable
from raceway.studies.measured.from_files import from_signals, refuse_no_load
from raceway.studies.measured.identified import Identified
from raceway.studies.measured.signals import signals_of

#: The answer, in the folder of the results.
CONTENT = "identify.json"


@door
def identify(
    signals: Any,
    scene: Any,
    *,
    slow_roll: Any = None,
    run_out: tuple[float, float] | None = None,
    columns: Mapping[str, str] | None = None,
    out: str | Path | None = None,
    plugins: Iterable[str | Path] = (),
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
    columns : head of a column -> name, ``{"X [um]": "y_um"}``; "ignore" leaves it out
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
        What is wrong with the signals or the scene.  Records of one axis, and of force and displacement, are read, and refused
        with what they hold and what is missing.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> signals = {
    ...     "time_s": time,
    ...     "y_um": 15.0 * np.cos(angle),
    ...     "z_um": 15.0 * np.sin(angle),
    ...     "speed_rpm": 12000.0 + 0.0 * time,
    ... }
    >>> rig = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "rig": {},  # a shaft of 426 mm with a disc, see ``raceway schema``
    ...     "integrator": {"kind": "quasi_static"},
    ... }
    >>> found = rw.identify(signals, rig)
    >>> round(1e-6 * found.equivalent_stiffness)  # K [N/um]
    84
    """
    if run_out is not None and slow_roll is not None:
        raise SceneError.at("run_out", run_out, "the slow roll tells it already: leave one of them out")
    registry = registry_with(plugins)
    read = as_scene(scene, plugins=plugins)
    rig = rig_of(read)
    refuse_no_load(read)
    folder = None if out is None else writable(Path(out))
    with telling(progress) as told:
        told("reading signals", 0, 3)
        record = signals_of(signals, columns)
        slow = None if slow_roll is None else signals_of(slow_roll, columns)
        found = from_signals(record, read, rig, registry, slow, run_out, told)
    made = Identified(found, read.title, record.source)
    if folder is not None:
        write_json(made.to_dict(), folder / CONTENT)
    return made
