"""What another start gives: with friction a motion remembers how it began.

Notes
-----
Where a contact sticks follows from the slip before, which no damping takes back: two starts under one force end on two steady
motions.  Their distance is no transient that dies out, and no window over the turns of one of them sees it.  A further run
begins otherwise, with the steps of the one that is made for the error of the time step: equal steps err alike.  Free vibrations,
which each run states as its own error, are taken from both.

The orbit without friction and the motions from rest are furthest apart; a growing force leaves the least free vibration.
"""

from __future__ import annotations

import attrs

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.errors import ConvergenceError, StabilityError
from raceway.pipeline.error.free_vibration import without_free_vibration
from raceway.pipeline.simulate import OnProgress, Simulation, simulate
from raceway.planning.steady_orbits import remembers_its_start
from raceway.storage.tables import Tables

#: Other starts in the order in which they are tried.
_OTHERS: dict[str, tuple[str, ...]] = {"orbit": ("ramp", "static"), "ramp": ("orbit", "static"), "static": ("orbit", "ramp")}
#: A series of equilibria knows no velocities: it begins under the force or under one that grows.
_SERIES: dict[str, tuple[str, ...]] = {"orbit": ("ramp",), "ramp": ("static",), "static": ("ramp",)}


@attrs.frozen
class Run:
    """Z [N/m] of a run without what its free vibration leaks into the 1x line, and its steps a turn."""

    value: complex
    steps: int

    @classmethod
    def of(cls, model: Model, equilibrium: Equilibrium, motion: Simulation) -> Run:
        clean = without_free_vibration(model, equilibrium, motion)
        if clean is not None:
            return cls(clean.value, motion.whole.schedule.steps_per_turn)
        found = model.scene.identifier.method.identify([motion.record], equilibrium, model)
        return cls(found.dynamic_stiffness, motion.whole.schedule.steps_per_turn)


def distance(
    model: Model, equilibrium: Equilibrium, first: Simulation, run: Run, on_progress: OnProgress | None = None
) -> tuple[float, str]:
    """Distance of Z from that of another start, over the smaller Z, and the name of that start.

    Parameters
    ----------
    first : the motion from the scene's own start;  run : from the same start, over as many turns

    Raises
    ------
    ConvergenceError, StabilityError
        No other start gives a motion.
    """
    kinds = (_OTHERS if model.scene.integrator.method.inertial else _SERIES)[first.start.kind]
    if not first.start.settled:
        kinds = tuple(kind for kind in kinds if kind != "orbit")  # searched for in vain
    failed: ConvergenceError | StabilityError | None = None
    for kind in kinds:
        one = _begun_by(model, kind)
        try:
            motion = simulate(one, equilibrium, on_progress, run.steps)
        except (ConvergenceError, StabilityError) as error:
            failed = error
            continue
        if motion.start.kind == kind:
            other = Run.of(one, equilibrium, motion).value
            return abs(run.value - other) / min(abs(run.value), abs(other)), kind
    raise failed or ConvergenceError("no orbit was found to start on")


def _begun_by(model: Model, kind: str) -> Model:
    """The same scene with another start."""
    scene = model.scene
    excitation = scene.excitation
    if getattr(excitation, "ramp_turns", 0.0) > 0.0:
        excitation = attrs.evolve(excitation, ramp_turns=0.0)
    scene = attrs.evolve(scene, excitation=excitation, integrator=attrs.evolve(scene.integrator, start=kind))
    return attrs.evolve(model, scene=scene)


def start_warnings(model: Model, error: Tables) -> list[str]:
    """Says that an error is not known because no other start could be compared with."""
    if not remembers_its_start(model.scene) or error["transient"] is not None:
        return []
    return [
        f"friction: how far the answer depends on the motion's start is not known, and so is its error: {error['how']['transient']}"
    ]
