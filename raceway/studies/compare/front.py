"""One scene with some keys varied, for Python and the command line alike: ``raceway.compare``."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.out.progress import ShowProgress, telling
from raceway.pipeline.result import write_json
from raceway.scene.given import plain_tables
from raceway.storage.files import writable
from raceway.studies.compare.comparison import Comparison
from raceway.studies.compare.study import compare as study

#: Finished runs, and the answer, in the folder of the results.
ROWS, CONTENT = "compare-rows.jsonl", "compare.json"


@door
def compare(
    scene: Any,
    vary: Mapping[str, Any] | Iterable[str],
    *,
    out: str | Path | None = None,
    kept: str | Path | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Comparison:
    """Vary some keys of a scene, all else the same, and say which of them causes what.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    vary : key of the scene -> its values (list, array (n,), or the text "a,b,c" or "start:stop:count"); every combination is run
    out : folder in which finished runs are kept and reused, and compare.json is written; None: nothing is written
    kept : file of the finished runs instead of that in ``out``
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Comparison
        ``rows`` with the numbers of each run, ``effects`` of each key and of two together, ``words`` that explain them

    Raises
    ------
    SceneError
        A mistake in the scene or in a value; nothing has been run.
    RacewayError
        A folder that cannot be written.

    Notes
    -----
    A run that is refused or fails is kept with its reason, and the others go on.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "amplitude": "constant", "force": 100.0},
    ...     "integrator": {"kind": "quasi_static"},
    ... }
    >>> found = rw.compare(scene, {"supports.tilt": ["locked", "free"]})
    >>> (1e-6 * found.to_xarray().equivalent_stiffness).round(0).values.tolist()  # K [N/um]
    [235.0, 31.0]
    """
    registry = registry_with(plugins)
    folder = None if out is None else writable(Path(out))
    kept = folder / ROWS if folder is not None and kept is None else kept
    tables = plain_tables(scene, registry=registry)
    with telling(progress) as told:
        found = study(tables, vary, registry, told, None if kept is None else Path(kept))
    if found.fault is not None:
        warnings.warn(str(found.fault), stacklevel=3)
    if folder is not None:
        write_json(found.to_dict(), folder / CONTENT)
    return found
