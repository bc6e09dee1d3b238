"""What another start gives: with friction a motion remembers how it began.

Notes
-----
Where a contact sticks follows from the slip before, which no damping takes back: two starts under one force end on two steady
motions.  Their distance is no transient that dies out, and no window over the turns sees it in one of them.  A second run
begins otherwise, with the steps of the run that is there already for the error of the time step: equal steps err alike.

The orbit without friction and the motions from rest differ most; under a growing force the contacts slip least.
"""

from __future__ import annotations

from typing import Any

import attrs

from raceway.errors import ConvergenceError, StabilityError
from raceway.model import Model
from raceway.planning.modules import remembers_its_start
from raceway.simulate import Simulation, simulate
from raceway.statics import Equilibrium

#: Other starts in the order in which they are tried.
_OTHERS = {"orbit": ("ramp", "static"), "ramp": ("orbit", "static"), "static": ("orbit", "ramp")}
#: A series of equilibria knows no velocities: it begins under the force or under one that grows.
_SERIES = {"orbit": ("ramp",), "ramp": ("static",), "static": ("ramp",)}


@attrs.frozen
class Run:
    """A run to compare with: Z [N/m], steps a turn."""

    value: complex
    steps: int


def other_start(model: Model, equilibrium: Equilibrium, first: Simulation, run: Run) -> tuple[float, str]:
    """Distance of Z from another start over the smaller Z, and the name of that start.

    Parameters
    ----------
    first : the motion of the scene's own start
    run : over all turns of the plan, from that start

    Raises
    ------
    ConvergenceError, StabilityError
        No other start gives a motion.
    """
    begun, why = first.start, ConvergenceError("the run began on no orbit, and under no other force")
    failed: ConvergenceError | StabilityError = why
    for kind in (_OTHERS if model.scene.integrator.method.inertial else _SERIES)[begun.kind]:
        if kind == "orbit" and not begun.settled:
            continue  # searched for in vain
        one = _begun_by(model, kind)
        try:
            motion = simulate(one, equilibrium, steps_per_turn=run.steps)
        except (ConvergenceError, StabilityError) as error:
            failed = error
            continue
        if motion.start.kind == begun.kind:
            continue
        value = model.scene.identifier.method.identify([motion.record], equilibrium, one).dynamic_stiffness
        return abs(run.value - value) / min(abs(run.value), abs(value)), kind
    raise failed


def _begun_by(model: Model, kind: str) -> Model:
    """The same scene with another start."""
    scene = model.scene
    excitation = scene.excitation
    if getattr(excitation, "ramp_turns", 0.0) > 0.0:
        excitation = attrs.evolve(excitation, ramp_turns=0.0)
    scene = attrs.evolve(scene, excitation=excitation, integrator=attrs.evolve(scene.integrator, start=kind))
    return attrs.evolve(model, scene=scene)


def start_warnings(model: Model, error: dict[str, Any]) -> list[str]:
    """Says that an error is not known because no other start could be compared with."""
    if not remembers_its_start(model.scene) or error["transient"] is not None:
        return []
    return [
        f"friction: how far the answer depends on the motion's start is not known, and so is its error: {error['how']['transient']}"
    ]
