"""Which scenes have points that are solved in compiled columns, and which continuous keys may be such columns."""

import math
from collections.abc import Mapping
from contextlib import suppress

import attrs
import numpy as np

from raceway.core.columns import with_values
from raceway.framework.contracts import ContactLaw
from raceway.framework.duties import finds_orbit, is_synchronous
from raceway.planning.resolve import Problem
from raceway.scene.keys import with_columns
from raceway.scene.lubricant import lubricated
from raceway.scene.scene import Scene

#: Continuous keys whose numbers may be columns; beside them those of the excitation.
_KEYS = frozenset([
    "load.axial", "load.radial[0]", "load.radial[1]", "load.moment[0]", "load.moment[1]", "kinematics.spin_speed_rpm",
    "kinematics.radial_expansion", "supports.tilt", "rotor.mass", "rotor.damping", "rotor.transverse_inertia",
    "rotor.polar_inertia", "contact.damping", "contact.time_constant", "contact.loss_factor", "bearing.bore",
    "bearing.outer_diameter", "bearing.width", "bearing.dynamic_rating", "bearing.static_rating",
    "bearing.first_ball_azimuth_deg", "bearing.rings.thermal_expansion", "bearing.balls.thermal_expansion",
    "bearing.ball_diameter", "bearing.pitch_diameter", "bearing.conformity_inner", "bearing.conformity_outer",
    "bearing.contact_angle_deg", "bearing.radial_clearance", "bearing.preload", "bearing.second_preload",
    "bearing.rings.young", "bearing.rings.poisson", "bearing.rings.density", "bearing.balls.young", "bearing.balls.poisson",
    "bearing.balls.density", "mounting.inner_temperature", "mounting.outer_temperature", "mounting.ball_temperature",
    "mounting.shaft_bore", "mounting.shaft_interference", "mounting.housing_interference",
])  # fmt: skip


def why_not(problem: Problem, moving: bool) -> str:
    """Why points of a scene, or their motions (``moving``), are computed one by one; empty where compiled loops do."""
    scene = problem.scene
    bearing, law = scene.bearing, scene.contact.law
    if why := problem.body_kind.why_no_columns():
        return why
    reasons = {
        "rollers move": moving and problem.traits.line_contacts,
        "the contact law has a memory": law.state_size > 0,
        "contacts rub": scene.contact.friction > 0.0,
        "dashpots are given as a band": scene.contact.in_a_band,
        "an axial displacement is held": scene.supports.axial == "displacement" and not problem.traits.line_contacts,
        "rows are on a spring, or ground individually": bearing.preloaded
        and (bearing.preload_kind == "spring" or bearing.preload_of == "row" or bool(bearing.row)),
        "balls orbit": moving and scene.kinematics.orbiting,
        "the speed changes": problem.spin_changes,
        "the motion is integrated over time": moving and not finds_orbit(problem.integrator.method),
        "the identifier is not of synchronous (1x) components": moving and not is_synchronous(scene.identifier.method),
    }
    return next((reason for reason, holds in reasons.items() if holds), "")


def why_no_column(problem: Problem, key: str) -> str:
    """Why the numbers at a continuous key can not be a column; empty where they can."""
    scene = problem.scene
    if why := problem.body_kind.why_no_columns(key):
        return why
    apart = key == "bearing.width" and scene.bearing.arrangement != "single"  # places of rows differ
    of_law = key in law_keys(scene)
    if of_law and not _same_kernel(scene.contact.law, key.partition(".")[2]):
        return f"the contact law's kernel is made from {key}"
    known = of_law or key.startswith(("excitation.", "quantities.", "lubricant.", "heat.")) or key in _KEYS and not apart
    return "" if known else f"{key} changes more than numbers"


def law_keys(scene: Scene) -> list[str]:
    """Keys of the contact law's own options."""
    return [f"contact.{field.name}" for field in attrs.fields(type(scene.contact.law))]


def _same_kernel(law: ContactLaw, option: str) -> bool:
    """Whether a number of a law's options reaches its kernel as a parameter."""
    for end in (-math.inf, math.inf):
        with suppress(ValueError):  # a rule of the option
            return attrs.evolve(law, **{option: math.nextafter(getattr(law, option), end)}).kernel() is law.kernel()  # type: ignore[misc]
    return False


@np.errstate(all="ignore")
def column_problem(problem: Problem, columns: Mapping[str, np.ndarray]) -> Problem:
    """What a problem asks for at n points, from the columns (n,) of its keys; tables without columns stay the same objects."""
    changed = with_columns(problem, columns)
    if any(key.startswith(("contact.", "lubricant.")) for key in columns):
        oil = None if problem.scene.lubricant is None else changed.lubricant
        changed = with_values(changed, **dict(zip(("contact", "lubricant"), lubricated(changed.contact, oil), strict=True)))
    return attrs.evolve(changed, points=(len(next(iter(columns.values()))),))
