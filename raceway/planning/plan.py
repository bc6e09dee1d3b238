"""Plan of a scene: parts kept and left out with reasons, predicted size and cost.  Nothing is built here.

The model builder obeys the plan; it decides nothing of this by itself.
"""

from __future__ import annotations

from collections.abc import Collection

import attrs

from raceway.framework.doors import door
from raceway.framework.duties import bodies
from raceway.planning.combinations import refuse_what_cannot_run
from raceway.planning.decisions import decide_balls, decide_motion, decide_output, decide_tilts
from raceway.planning.machine import slowness
from raceway.planning.parts import Decisions, Part
from raceway.planning.recording import refuse_memory
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


@attrs.frozen
class Plan:
    """Decisions and predictions for one scene.

    Attributes
    ----------
    balls : "weightless" (races in series), "inertial" (two unknowns each) or "tangential" (friction, gyroscopic moments)
    centrifugal, gyroscopic : whether the balls have these loads
    free : (5,) of x, y, z, tilt_y, tilt_z: 1 for unknowns
    turns : turns that are integrated
    dofs : unknowns of the ring and of the balls
    time_step_s : None in a static scene;  predicted_wall_s : of a whole run on this machine
    predicted_work_s : the same on the machine whose times the plan knows: no machine's speed changes it
    predicted_bytes : resident memory at the peak; 0 where it is small, or not known
    at_least : whether that may be any number of times more: a mesh whose size is not known before it is read
    predicted_once_s : seconds of that which a second run on the same bodies does not take again
    mesh : predicted ``bodies[{name, cells, bytes}]``, ``cells``, ``bytes``; None where nothing is meshed or can be told
    """

    kept: tuple[Part, ...]
    left_out: tuple[Part, ...]
    balls: str
    centrifugal: bool
    gyroscopic: bool
    free: tuple[int, ...]
    turns: int
    dofs: int
    time_step_s: float | None
    predicted_steps: int
    predicted_wall_s: float
    predicted_work_s: float
    predicted_once_s: float = 0.0
    predicted_bytes: int = 0
    mesh: Tables | None = None
    at_least: bool = False

    def keeps(self, part: str) -> bool:
        """Whether a part is kept, by its name."""
        return any(one.part == part for one in self.kept)

    def to_dict(self) -> Tables:
        """Content of the table ``plan`` of result.json."""
        return {
            "kept": [attrs.asdict(p) for p in self.kept],
            "left_out": [attrs.asdict(p) for p in self.left_out],
            "dofs": self.dofs,
            "time_step_s": self.time_step_s,
            "predicted_steps": self.predicted_steps,
            "predicted_wall_s": self.predicted_wall_s,
            "predicted_at_least": self.at_least,
            "predicted_bytes": self.predicted_bytes or None,
            "mesh": self.mesh,
        }


@door
def make_plan(scene: Scene, force: Collection[str] = ()) -> Plan:
    """Decide what a scene needs.

    Parameters
    ----------
    force : parts that are kept although the scene does not need them: to measure what leaving them out saves

    Raises
    ------
    SceneError
        For combinations that cannot run, each with the reason and the remedy.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.make_plan(rw.Scene.from_toml("examples/b7206.toml")).time_step_s  # [s]
    1.388888888888889e-05
    """
    refuse_what_cannot_run(scene)
    parts = Decisions(force)
    tilts = decide_tilts(scene, parts)
    balls = decide_balls(scene, parts)
    bodies(scene, "decide", parts)
    motion = decide_motion(scene, parts, tilts, balls.friction)
    decide_output(scene, parts, motion)
    count = scene.bearing.balls_in_all
    if motion.recorded:
        refuse_memory(scene, motion.turns, motion.steps_per_turn, count)
    cost = bodies(scene, "cost", balls, motion, parts)
    free = (0 if scene.supports.axial == "displacement" else 1, 1, 1, int(tilts), int(tilts))
    unknowns = sum(free) + count * (1 if balls.kind == "weightless" else 2)
    return Plan(
        kept=tuple(parts.kept),
        left_out=tuple(parts.left_out),
        balls=balls.kind,
        centrifugal=balls.centrifugal,
        gyroscopic=balls.gyroscopic,
        free=free,
        turns=motion.turns,
        dofs=cost.unknowns or unknowns,
        time_step_s=_period(scene) / motion.steps_per_turn if motion.recorded else None,
        predicted_steps=motion.turns * motion.steps_per_turn,
        predicted_wall_s=cost.seconds * (slowness() if cost.scales else 1.0),
        predicted_work_s=cost.seconds,
        predicted_once_s=cost.once,
        predicted_bytes=cost.bytes,
        mesh=cost.mesh,
        at_least=cost.at_least,
    )


def _period(scene: Scene) -> float:
    """Of the force [s]."""
    return float(scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz)
