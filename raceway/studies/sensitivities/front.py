"""Sensitivities of one scene, for Python: ``raceway.sensitivities``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raceway.bodies.model import build_model
from raceway.core.jit import working_processor_time
from raceway.errors import Mistake, SceneError
from raceway.framework.doors import door
from raceway.out.progress import telling
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.continuous import continuous_keys, key_of
from raceway.scene.given import as_scene
from raceway.studies.sensitivities.sensitivities import Sensitivities, sensitivities_of

if TYPE_CHECKING:
    from raceway.out.progress import ShowProgress


@door
def sensitivities(
    scene: Any, keys: Iterable[str] = (), *, progress: ShowProgress = None, plugins: Iterable[str | Path] = ()
) -> Sensitivities:
    """Derivatives of displacement, stiffness and ball loads, and of Z, K and C of the steady orbit, by numbers of a scene.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    keys : paths such as "load.axial"; none: every continuous key of the scene
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Sensitivities

    Notes
    -----
    By the implicit function theorem on the exact tangents: nothing is solved again.  The motion is the steady orbit that
    ``integrator.kind`` = "periodic" solves for, whatever the scene's integrator.

    Raises
    ------
    SceneError
        With every mistake of the scene; a key that is not continuous or has no derivative; bodies whose contacts have no derivative.
    ConvergenceError
        No equilibrium or no steady orbit.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sensitivities({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}, ["load.axial"])
    >>> round(found["load.axial"].influence["kxx"], 2)  # kxx grows by 0.54 % where the load grows by 1 %
    0.54
    """
    read = as_scene(scene, plugins=plugins)
    keys = list(keys)
    chosen = [key_of(read, path) for path in keys] or continuous_keys(read)
    with telling(progress) as told:
        begun = working_processor_time()
        model = build_model(read, make_plan(read))
        equilibrium = settle(model)
        found = sensitivities_of(model, equilibrium, chosen, working_processor_time() - begun, told)
    if keys and found.refused:
        raise SceneError([Mistake(key.path, key.value, why) for key, why in found.refused])
    return found
