"""What a scene may ask of bodies beyond a plain one, and how a system shows that it is there."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.storage.tables import Tables

#: Keys by table.
Changes = dict[str, Tables]
#: Model, equilibrium, and the displacement (5,) of the plain scene.
Shows = Callable[[Model, Equilibrium, np.ndarray], bool]


@attrs.frozen
class Asked:
    """Changes of a scene, and whether a bearing shows them."""

    changes: Changes
    shows: Shows


def _moves(_model: Model, found: Equilibrium, plain: np.ndarray) -> bool:
    return not np.array_equal(found.displacement, plain)


def _has_no_potential(model: Model, _found: Equilibrium, _plain: np.ndarray) -> bool:
    return not model.system.conservative


def _is_damped(model: Model, found: Equilibrium, _plain: np.ndarray) -> bool:
    """Bodies that are stepped from Python may know rates in motion only."""
    return not model.traits.compiled or bool(model.system.evaluate(found.displacement, ball=found.ball).damping.any())


def _passes(model: Model, found: Equilibrium, _plain: np.ndarray) -> bool:
    """Rolling elements are elsewhere a millisecond later."""
    system, q = model.system, found.displacement
    now, later = (system.evaluate(q, ball=found.ball, t=t).contact_force for t in (0.0, 1e-3))
    return not np.array_equal(now, later)


#: What a plain scene has none of.
PLAIN: Changes = {"kinematics": {"ball_inertia": False}}
OTHERS = {
    "free tilts": Asked(
        {"supports": {"tilt": "free"}, "rotor": {"mass": 1.0, "transverse_inertia": 1e-3}},
        lambda model, _found, _plain: bool(model.system.free[3:].all()),
    ),
    "a held axial displacement": Asked(
        {"supports": {"axial": "displacement"}}, lambda model, _found, _plain: bool(model.system.free[0] == 0.0)
    ),
    "a pair of rows": Asked(
        {"bearing": {"arrangement": "DB", "row_distance": 0.02}},
        lambda model, _found, _plain: model.system.ball_count == 2 * model.scene.bearing.ball_count,
    ),
    "an expanded inner ring": Asked({"kinematics": {"radial_expansion": 1e-6}}, _moves),
    "a soft seat": Asked({"supports": {"outer_seat": 1e13}}, _moves),
    "surface points": Asked({"contact": {"discretisation": "nodal"}}, _moves),
    "inertia of the balls": Asked({"kinematics": {"ball_inertia": True}}, _moves),
    "gyroscopic moments": Asked({"kinematics": {"ball_inertia": True, "gyroscopic": "outer_race"}}, _has_no_potential),
    "orbiting balls": Asked({"kinematics": {"orbiting": True}}, _passes),
    "friction": Asked({"contact": {"friction": 0.05}}, _has_no_potential),
    "damping of the contacts": Asked({"contact": {"damping": 100.0}}, _is_damped),
}
