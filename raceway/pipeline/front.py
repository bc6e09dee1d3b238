"""One scene computed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import attrs

from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import KYY, KYY_TILTS_FOLLOW
from raceway.errors import RacewayError
from raceway.framework.doors import DURATION, PATH, PATHS, TEXTS, door
from raceway.framework.loading.registry import default_registry, registry_with
from raceway.pipeline import PATIENCE
from raceway.storage.files import writable

if TYPE_CHECKING:
    from raceway.pipeline.result import Result
    from raceway.scene.scene import SceneSource

#: Time that a note is worth [s].
_NOTE_S = 10.0


@door
def run(
    scene: SceneSource,
    *,
    progress: ShowProgress = None,
    reports: Annotated[Iterable[str], TEXTS] = (),
    patience: Annotated[float, DURATION] = PATIENCE,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    out: Annotated[str | Path | None, PATH] = None,
) -> Result:
    """Compute one scene: equilibrium, motion, dynamic stiffness with its error and cost.

    Writes DIR/result.json; after a numerical failure (exit code 1) DIR/failure.json and DIR/last-good-state.npz.  Reports are plug-ins
    (raceway dev plugins); a report that fails is named after the result is saved.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)`` between chunks of steps; an exception
        stops the run
    reports : name of a report to write as well
    patience : multiple of the predicted time or memory at which a run is stopped; ``inf``: never
    plugins : files of one-off plug-ins that the scene uses
    out : folder in which result.json and reports are written; None: nothing is written

    Returns
    -------
    Result

    Raises
    ------
    SceneError
        With every mistake of the scene; a combination that cannot run.
    ConvergenceError, StabilityError, BeyondPlanError
        No solution, or none in the time allowed; ``error.state`` holds the last good arrays.
    RacewayError
        A folder that cannot be written, before anything is computed.

    Examples
    --------
    >>> import raceway as rw
    >>> result = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> round(float(result.displacement[0]) * 1e6, 1)  # of the inner ring along the axis [um]
    29.9
    """
    from raceway.pipeline.result import chosen_reports
    from raceway.pipeline.run import run as compute
    from raceway.scene.scene import as_scene

    read, writers = as_scene(scene, plugins=plugins), chosen_reports(reports, registry_with(plugins))
    folder = None if out is None else writable(Path(out))
    with telling(progress) as report:
        result = attrs.evolve(compute(read, default_registry(), report, patience=patience), reports=tuple(writers))
    if folder is not None:
        result.save(folder)
    return result


def radial_note(scene: SceneSource) -> list[str]:
    """For who reads coefficients of a scene: the interval of its radial stiffness at rest; empty where an equilibrium takes long."""
    from raceway.pipeline.uncertainty import stated
    from raceway.planning.plan import make_plan
    from raceway.scene.scene import as_scene, plain_tables

    try:
        still = as_scene({**plain_tables(scene, registry=default_registry()), "identifier": {"kind": "tangent"}})
        if make_plan(still).predicted_wall_s > _NOTE_S:
            return []
        result = run(still)
    except RacewayError:
        return []
    quantity = KYY if result.kyy_tilts_follow is None else KYY_TILTS_FOLLOW
    label, value, words = stated(quantity, {"uncertainty": result.uncertainty})
    return [f"{label} of the scene itself {value}, {words}"]
