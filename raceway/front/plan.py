"""What a run of a scene would build, and what not."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.shown import Fact, Shown, number
from raceway.planning.implausible import foreseen
from raceway.planning.plan import Plan, make_plan
from raceway.scene.given import as_scene


@attrs.frozen(repr=False)
class ScenePlan(Shown, Plan):
    """A plan that says which scene it is of.

    Attributes
    ----------
    title : str, of the scene
    kept, left_out : tuple of Part, each with ``part`` and ``why``
    dofs : int, unknowns;  time_step_s : float or None [s];  predicted_steps : int
    predicted_wall_s : float, of a whole run on this machine [s]

    Examples
    --------
    >>> import raceway as rw
    >>> plan = rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
    >>> plan.predicted_steps, plan.time_step_s
    (0, None)
    """

    title: str = attrs.field(default="", kw_only=True)

    def _shown(self) -> tuple[str, list[Fact]]:
        step = "static" if self.time_step_s is None else f"{self.predicted_steps} steps of {self.time_step_s:.3g} s"
        time = "time not known before the mesh is read" if self.at_least else number(self.predicted_wall_s, "s", 2)
        head: list[Fact] = [
            ("predicted", "", f"{time}; {step}; {self.dofs} unknowns"),
            ("kept", "", ", ".join(one.part for one in self.kept)),
        ]
        return self.title, [*head, *(("left out", "", f"{one.part}: {one.why}") for one in self.left_out)]


@door
def plan(scene: Any, *, plugins: Iterable[str | Path] = ()) -> ScenePlan:
    """Decide what a scene needs, and predict size, time step and cost; nothing is built.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    ScenePlan : ``kept``, ``left_out``, ``dofs``, ``time_step_s`` [s], ``predicted_wall_s`` [s] ...

    Raises
    ------
    SceneError
        With every mistake that ``raceway.check`` finds.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}).dofs
    15
    """
    read = as_scene(scene, plugins=plugins)
    if mistakes := foreseen(read):
        raise SceneError(mistakes)
    made = make_plan(read)
    values = {str(field.alias): getattr(made, field.name) for field in attrs.fields(Plan)}
    return ScenePlan(**values, title=read.title)
