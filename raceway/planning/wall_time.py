"""How long a run will take, from measured times of its parts."""

from __future__ import annotations

from raceway.planning.decisions import Balls, Motion
from raceway.planning.elastic import ElasticCost
from raceway.planning.patches import PatchCost
from raceway.planning.sections import section_cost
from raceway.scene import Scene

#: Seconds, measured on one core of a small server: a whole step for 12 balls.
_STEP_S = {"weightless": 1.3e-6, "inertial": 3.0e-6, "tangential": 12.0e-6}
#: The same for condensed bodies, and what the matrices between balls add.
_CONDENSED_STEP_S = {"weightless": 10.5e-6, "inertial": 13.5e-6, "tangential": 22.0e-6}
_BETWEEN_S = 23.0e-6
#: Start-up with warm caches.
START_S = 0.6


def predicted_wall(
    scene: Scene, balls: Balls, motion: Motion, coupled: bool, elastic: ElasticCost | None, patches: PatchCost | None
) -> float:
    """Wall time of a run [s], compiled kernels in the cache, deforming bodies not."""
    count = scene.bearing.ball_count * len(scene.bearing.rows)
    steps = motion.turns * motion.steps_per_turn
    if elastic is not None:
        before = elastic.equilibrium_s + (elastic.start_s if motion.recorded else 0.0)
        return START_S + before + steps * elastic.step_s
    each = _STEP_S[balls.kind]
    if scene.bodies.kind == "condensed":
        between = _BETWEEN_S * (scene.bearing.ball_count / 12.0) ** 2 if coupled else 0.0
        each = _CONDENSED_STEP_S[balls.kind] + between
    if patches is not None:
        each = 12.0 / count * patches.step_s
    each *= count / 12.0 * (0.5 if not scene.integrator.method.implicit else 1.0)
    # Half as much again for what compiled loops share out differently.
    return START_S + _before(scene, patches) + 1.5 * steps * each


def _before(scene: Scene, patches: PatchCost | None) -> float:
    """Time [s] that deforming bodies take before the first step, nothing kept from before."""
    if scene.bodies.kind != "condensed":
        return 0.0
    if patches is None:
        return section_cost(scene).seconds
    orbit = 150.0 * patches.step_s if scene.excitation is not None else 0.0
    return patches.setup_s + 3.0 * patches.equilibrium_s + orbit
