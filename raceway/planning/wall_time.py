"""Predicted time of a run, from measured times of its parts.

Constants are seconds of processor time of the reference machine of ``raceway.planning.machine``, with all that a run does
for its error beside its answer: `python -m benchmarks.plan_time` holds whole runs against them.
"""

from __future__ import annotations

import attrs

from raceway.planning.decisions import Balls, Motion
from raceway.planning.elastic import ElasticCost
from raceway.planning.patches import PatchCost
from raceway.planning.recording import recorded_per_turn
from raceway.planning.sections import section_cost
from raceway.planning.steady_orbits import remembers_its_start
from raceway.scene.tables import Scene

#: A step for 12 balls, of an implicit method; and how much less an explicit one takes, whose steps iterate less.
_STEP_S = {"weightless": 2.3e-6, "inertial": 3.3e-6, "tangential": 16.0e-6}
_EXPLICIT = 0.5
#: The same for condensed bodies, and what the matrices between balls add.
_CONDENSED_STEP_S = {"weightless": 10.0e-6, "inertial": 11.0e-6, "tangential": 22.0e-6}
_BETWEEN_S = 40.0e-6
#: An equilibrium of a series, over a step in time.
_EQUILIBRIUM = 6.0
#: Steps of a run and its second one with half as many, and those with a third one from another start, over the first two.
_WITH_HALF, _FROM_ANOTHER_START = 1.5, 4.0 / 3.0
#: A sample of the record: lines, energies and extremes of 12 balls.
_SAMPLE_S, _CONDENSED_SAMPLE_S = 8.0e-6, 14.0e-6
#: A step in which the speed changes: one call from Python each.
_CHANGING_S = 130.0e-6
#: A steady orbit; the search for further ones, and from which amplitude over the axial load on: a force along a fixed
#: direction on free tilts meets internal resonances.  The search takes 0.3 to 9 s: what it will meet is not known before.
_ORBIT_S, _SEARCH_S, _SEARCH_FROM = 0.02, 3.0, 0.4
#: What condensed bodies make of one evaluation of the rigid ones in it.
_CONDENSED_SEARCH = 2.5
#: Start-up with warm caches, to the first result.
START_S = 1.2


def predicted_work(
    scene: Scene, balls: Balls, motion: Motion, coupled: bool, elastic: ElasticCost | None, patches: PatchCost | None
) -> float:
    """Processor time of a run on the reference machine [s], compiled kernels in the cache, deforming bodies not."""
    count = scene.bearing.ball_count * len(scene.bearing.rows)
    steps = motion.turns * motion.steps_per_turn
    again = _FROM_ANOTHER_START if motion.recorded and remembers_its_start(scene) else 1.0
    if elastic is not None:
        before = elastic.equilibrium_s + (elastic.start_s if motion.recorded else 0.0)
        if scene.contact.discretisation == "resultant":  # calibrated as the bearing's own condensed rings
            before += section_cost(attrs.evolve(scene, mesh=None)).seconds
        return START_S + before + steps * elastic.step_s
    work = START_S + _before(scene, patches)
    if not motion.recorded:
        return work
    method, condensed = scene.integrator.method, scene.bodies.kind == "condensed"
    if patches is not None:
        return work + _WITH_HALF * again * steps * patches.step_s
    each = (_CONDENSED_STEP_S if condensed else _STEP_S)[balls.kind]
    each += _BETWEEN_S * (scene.bearing.ball_count / 12.0) ** 2 if condensed and coupled else 0.0
    each *= again * count / 12.0 * (1.0 if method.implicit else _EXPLICIT) * (1.0 if method.inertial else _EQUILIBRIUM)
    if getattr(scene.excitation, "first_speed_rpm", None) is not None:
        each += _CHANGING_S
    sample = count / 12.0 * (_CONDENSED_SAMPLE_S if condensed else _SAMPLE_S)
    samples = motion.turns * recorded_per_turn(motion.steps_per_turn, motion.turns, method.inertial)
    return work + _orbits(scene) + samples * sample + (0.0 if getattr(method, "steady", False) else steps * each)


def _orbits(scene: Scene) -> float:
    """Time [s] for the steady orbit that is the answer, or that a transient starts on."""
    excitation, load = scene.excitation, abs(scene.load.axial)
    if excitation is None or not scene.integrator.method.inertial:
        return 0.0
    searched = scene.supports.tilt != "locked" and excitation.sense == 0
    searched = searched and excitation.amplitude_n > _SEARCH_FROM * load
    factor = _CONDENSED_SEARCH if scene.bodies.kind == "condensed" else 1.0
    return factor * (_SEARCH_S if searched else _ORBIT_S)


def _before(scene: Scene, patches: PatchCost | None) -> float:
    """Time [s] that deforming bodies take before the first step, nothing kept from before."""
    if scene.bodies.kind != "condensed":
        return 0.0
    if patches is None:
        return section_cost(scene).seconds
    orbit = 150.0 * patches.step_s if scene.excitation is not None else 0.0
    return patches.setup_s + 3.0 * patches.equilibrium_s + orbit
