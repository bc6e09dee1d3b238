"""Error against run time of a scene's settings, for Python and the command line alike: ``raceway.precision``."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.out.progress import ShowProgress, telling
from raceway.scene.given import plain_tables
from raceway.storage.files import writable
from raceway.studies.precision.result import Precision
from raceway.studies.precision.study import LIMIT_S, REPEATS
from raceway.studies.precision.study import precision as study

#: Finished rows, in the folder of the results.
ROWS = "precision-rows.jsonl"


@door
def precision(
    scene: Any,
    vary: Mapping[str, Any] | Iterable[str] | None = None,
    *,
    reference: Mapping[str, Any] | Iterable[str] = (),
    repeats: int = REPEATS,
    limit_s: float = LIMIT_S,
    out: str | Path | None = None,
    kept: str | Path | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Precision:
    """Run a scene with many settings: what each costs, and how far it is from a reference with a known bound.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    vary : key of the scene -> its values, whose combinations are run; None: a design made for the scene
    reference : key -> value of the reference; found by itself without
    repeats : runs of each setting, of which the fastest counts
    limit_s : settings that are predicted to take longer are left out [s]
    out : folder in which finished rows are kept and reused, and precision.json and .md are written; None: nothing is written
    kept : file of the finished rows instead of that in ``out``
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Precision
        ``judged`` rows with error and time [s], the ``front`` of those that no other beats, the ``cheapest`` within an error

    Raises
    ------
    SceneError
        A mistake in the scene, a value or the reference; nothing has been run.
    RacewayError
        A folder that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3.2e-4},
    ...     "rotor": {"mass": 2.0},
    ... }
    >>> found = rw.precision(scene, {"integrator.steps_per_turn": [45, 90]}, repeats=1)
    >>> found.judged[1]["error"] < found.judged[0]["error"]
    True
    """
    registry = registry_with(plugins)
    folder = None if out is None else writable(Path(out))
    kept = folder / ROWS if folder is not None and kept is None else kept
    tables = plain_tables(scene, registry=registry)
    with telling(progress) as told:
        found = study(tables, vary or (), reference, repeats, limit_s, None if kept is None else Path(kept), registry, told)
    if found.fault is not None:
        warnings.warn(str(found.fault), stacklevel=3)
    if folder is not None:
        found.write(folder, pictures=False)
    return found
