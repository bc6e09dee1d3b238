"""The band of a scene, for Python: ``raceway.band``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import default_registry
from raceway.out.progress import telling
from raceway.scene.given import as_scene, leaves
from raceway.scene.tolerance import tolerances_of
from raceway.studies.band.study import Band, band_of

if TYPE_CHECKING:
    from raceway.out.progress import ShowProgress


@door
def band(
    scene: Any,
    tolerances: Mapping[str, str] | Iterable[str] = (),
    *,
    count: int = 512,
    seed: int = 1,
    processes: int = 0,
    kept: str | Path | None = None,
    progress: ShowProgress = None,
    plugins: Iterable[str | Path] = (),
) -> Band:
    """The range of stiffness, displacement and ball loads over tolerances of a scene, and which of them causes it.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    tolerances : key -> text, such as {"load.axial": "±10 %", "bearing.contact_angle_deg": "±1 deg"}; or texts KEY=TEXT; none: the
        scene's table [tolerances]
    count : n, a power of 2: (d + 2) n samples for d tolerances;  seed : of the samples
    processes : that work at a time; 0: in this one
    kept : file of finished samples, read and added to
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Band

    Raises
    ------
    SceneError
        With every mistake of the scene; a tolerance that is none.
    ConvergenceError
        The scene, or every sample of it, has no answer.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.band({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}, {"load.axial": "±10 %"}, count=64)
    >>> round((found.high["kxx"] / found.low["kxx"] - 1.0) * 100.0, 1)  # 95 % of an even 20 %, to a power near 1/2 [%]
    10.9
    """
    read = as_scene(scene, plugins=plugins)
    if count < 2 or count & (count - 1):
        raise SceneError.at(
            "count", count, "must be a power of 2, at least 2: the samples of a Sobol' sequence are balanced then"
        )
    chosen = tolerances_of(read, tolerances or dict(leaves(read.source.get("tolerances", {}))))
    with telling(progress) as told:
        return band_of(
            read,
            chosen,
            count,
            seed,
            default_registry(),
            processes,
            None if kept is None else Path(kept),
            [Path(one) for one in plugins],
            told,
        )
