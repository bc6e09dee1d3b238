"""What a run of a scene would build, and what not."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from raceway.framework.registry import default_registry
from raceway.planning.plan import Plan, make_plan
from raceway.scene.given import as_scene


def plan(scene: Any, *, plugins: Iterable[str | Path] = ()) -> Plan:
    """Decide what a scene needs, and predict size, time step and cost; nothing is built.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Plan : ``kept``, ``left_out``, ``dofs``, ``time_step_s`` [s], ``predicted_wall_s`` [s] ...

    Raises
    ------
    SceneError
        With every mistake of the scene; a combination that cannot run.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}).dofs
    15
    """
    read = as_scene(scene, plugins=plugins)
    return make_plan(read, registry=default_registry())
