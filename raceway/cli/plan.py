"""``raceway plan``."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from math import pi
from pathlib import Path
from typing import ClassVar

import attrs
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Column, Table

from raceway.answers.answer import Answer, Part
from raceway.answers.table import Row, Words, grouped, number, sections
from raceway.errors import SceneError
from raceway.framework.shown import duration
from raceway.planning import parts
from raceway.planning.plan import ScenePlan, check, make_plan
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


@attrs.frozen(repr=False, slots=False)
class _Planned(Answer):
    """A plan with its title, and that nothing is wrong."""

    stem: ClassVar[str] = "plan"
    title: str
    plan: ScenePlan

    def to_dict(self) -> Tables:
        return {"title": self.title, "errors": [], **self.plan.to_dict()}

    def report(self) -> Iterator[Part]:
        """Size, memory and time, then the parts included and left out."""
        yield Words(self.title, "bold")
        plan, problem = self.plan, self.plan.problem
        step = number(plan.time_step_s, "s", 3) if plan.time_step_s else "none"
        memory, wall_time = plan.predicted_bytes, ("not known", "unknown before the mesh is read")
        if not plan.at_least:
            wall_time = duration(plan.predicted_wall_s), "with compiled kernels in the cache"
        steps = ("steps per turn", number(problem.steps_per_turn), problem.why("steps_per_turn"))
        size: list[Row] = [
            ("Size and cost, predicted", "", ""),
            ("degrees of freedom", str(plan.dofs), "ring and balls"),
            *([("memory", f"{memory / 2**20:.3g} MiB", "at the peak")] if memory else []),
            ("wall time", *wall_time),
            ("time step", step, f"{plan.predicted_steps} steps"),
            *([steps] if plan.time_step_s else []),
            ("spin speed", number(30.0 / pi * problem.spin_speed, "r/min"), problem.why("spin_speed")),
        ]
        if (mesh := plan.mesh) is not None:  # all bodies, and each; balls in one line
            peak = f"{mesh['bytes'] / 2**20:.4g} MiB peak while meshing"
            size += [("Mesh, predicted", "", ""), ("hexahedra", str(mesh["cells"]), peak)]
            bodies = {body["name"]: (body["cells"], body["bytes"]) for body in mesh["bodies"]}
            for name, (cells, bytes_of_body) in grouped(bodies):
                each = " each" if name.startswith("balls (") else ""
                size.append((name, str(cells), f"{bytes_of_body / 2**20:.3g} MiB{each}"))
        yield sections(size)
        yield from (_reasons("Included", plan.kept), _reasons("Left out", plan.left_out))


def plan(scene: Scene, plugins: Iterable[str | Path] = ()) -> _Planned:
    """Validate a scene; list the physics included and left out with reasons, predicted size, time step, time and memory.

    Computes nothing. Every mistake is listed with key, value, rule and nearest valid choice.
    """
    answer = check(scene, plugins=plugins)
    if answer.mistakes:
        raise SceneError(answer.mistakes)
    for text in answer.warnings:
        warnings.warn(text, stacklevel=2)
    return _Planned(scene.title, make_plan(scene))


def _reasons(heading: str, items: Sequence[parts.Part]) -> RenderableType:
    table = Table.grid(Column(width=32), "", padding=(0, 2))
    for item in items:
        table.add_row(Words(item.part), Words(item.why, "dim"))
    return Group(Words(heading, "bold"), Padding(table, (0, 0, 0, 2)))
