"""Extreme scenes, penalties, surface points, elastic bodies, refusals and warnings of the catalogue: data."""

from __future__ import annotations

from raceway.storage.tables import Tables
from raceway.studies.stability.systems import UNDAMPED

Changes = Tables


def force(newton: float) -> Changes:
    """A rotating force that is the same at every speed."""
    return {"excitation.amplitude": "constant", "excitation.force": newton}


#: Geometry without the dimensions that give the inner ring a mass of its own.
_BARE = {"bearing.bore": None, "bearing.outer_diameter": None, "bearing.width": None, "bearing.preset": None}
_B7206C = {
    "bearing.ball_diameter": 9.525e-3, "bearing.pitch_diameter": 46e-3, "bearing.ball_count": 12,
    "bearing.conformity_inner": 0.522, "bearing.conformity_outer": 0.522, "bearing.contact_angle_deg": 15.0,
}  # fmt: skip
RUBBER, CERAMIC = {"young": 1e7, "poisson": 0.49, "density": 1100.0}, {"young": 310e9, "poisson": 0.26, "density": 3200.0}
NEARLY_INCOMPRESSIBLE: Changes = {"bearing.rings": {"poisson": 0.4999}, "bearing.balls": {"poisson": 0.4999}}
_RUBBER_BALLS: Changes = {"bearing.rings": CERAMIC, "bearing.balls": RUBBER, "load.axial": 10.0}
STATIC: Changes = {"kinematics.ball_inertia": False}
#: The whole force from the first step on: while a force grows, energy is not balanced.
SUDDEN: Changes = {"integrator.start": "static"}

#: name, what changes in the base, whether the closed form of an axial load holds, and how the motion is judged:
#: "orbit" by the steady orbit, "slow" by the series of equilibria, "finer" by finer steps and the balance of energy where no
#: orbit is steady or friction remembers, "" for the equilibrium alone.
SCENES: tuple[tuple[str, Changes, bool, str], ...] = (
    ("base", {}, True, "orbit"),
    ("axial load 1 N", {"load.axial": 1.0, **force(0.1), **STATIC}, False, "orbit"),
    ("axial load 1 N under 50 N rotating: rattling", {"load.axial": 1.0, **force(50.0), **STATIC, **SUDDEN}, False, "finer"),
    ("axial load 100 kN", {"load.axial": 1e5, **force(400.0)}, True, "orbit"),
    ("speed 1 r/min", {"excitation.speed_rpm": 1.0, **force(400.0), "integrator.turns": 3}, True, "slow"),
    ("speed 200 000 r/min", {"excitation.speed_rpm": 2e5, **force(100.0)}, False, "orbit"),
    ("radial load = axial", {"load.radial": [1000.0, 0.0], **force(100.0)}, False, "orbit"),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0], **force(100.0)}, False, "orbit"),
    ("radial load 20 x axial", {"load.radial": [20000.0, 0.0], **force(300.0)}, False, "orbit"),
    ("radial load 50 x axial", {"load.radial": [50000.0, 0.0], **force(300.0)}, False, "orbit"),
    ("lift-off: rotating 3000 N at 1000 N axial", force(3000.0), True, "orbit"),
    ("3 balls", {"bearing.ball_count": 3, **force(100.0)}, True, "orbit"),
    (
        "60 balls",
        {"bearing.ball_diameter": 4e-3, "bearing.pitch_diameter": 80e-3, "bearing.ball_count": 60, **_BARE,
         "bearing.conformity_inner": 0.522, "bearing.conformity_outer": 0.522, "bearing.contact_angle_deg": 15.0},
        True, "orbit",
    ),
    ("conformity 0.501", {"bearing.conformity_inner": 0.501, "bearing.conformity_outer": 0.501}, False, "orbit"),
    ("conformity 0.60", {"bearing.conformity_inner": 0.6, "bearing.conformity_outer": 0.6}, True, "orbit"),
    (
        "loose: clearance 50 um, rattling",
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 50e-6, "load.axial": 20.0, **force(200.0), **STATIC},
        False, "finer",
    ),
    (
        "clearance 20 um",
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 20e-6, **force(100.0)},
        True, "orbit",
    ),
    ("interference 5 um", {"kinematics.radial_expansion": 5e-6, **force(100.0)}, False, "orbit"),
    ("interference 20 um", {"kinematics.radial_expansion": 20e-6, **force(100.0)}, False, "orbit"),
    ("Poisson's ratio 0.4999", NEARLY_INCOMPRESSIBLE, True, "orbit"),
    ("rubber balls in ceramic rings", {**_RUBBER_BALLS, **force(1.0), "rotor.mass": 0.1, **STATIC}, True, "orbit"),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}, True, "orbit"),
    ("friction 0.3", {"contact.friction": 0.3, **force(100.0)}, True, "finer"),
    ("friction 1.0", {"contact.friction": 1.0, **force(100.0)}, True, "finer"),
    ("gyroscopic moments, 40 000 r/min", {"kinematics.gyroscopic": "outer_race", "excitation.speed_rpm": 4e4, **force(100.0)}, False, "orbit"),
    ("orbiting balls", {"kinematics.orbiting": True}, True, "orbit"),
    ("rotor of 1 g", {**_BARE, **_B7206C, "rotor.mass": 1e-3}, True, "orbit"),
    ("rotor of 10 t", {"rotor.mass": 1e4}, True, "orbit"),
    ("tilt free", {"supports.tilt": "free", **force(100.0)}, False, "orbit"),
    ("tilt free, radial load = axial", {"supports.tilt": "free", "load.radial": [1000.0, 0.0], **force(50.0)}, False, "orbit"),
    ("no damping", dict(UNDAMPED), True, "orbit"),
)  # fmt: skip

#: Those that are run with elastic rings and balls, too.
CONDENSED = (
    "base", "axial load 1 N", "axial load 100 kN", "radial load 5 x axial, balls unloaded", "3 balls", "conformity 0.501",
    "lift-off: rotating 3000 N at 1000 N axial", "Poisson's ratio 0.4999", "rubber balls in ceramic rings",
    "ceramic balls in steel rings", "friction 0.3", "tilt free",
)  # fmt: skip
#: Those that are run unless all is asked for.
QUICK = (
    "base", "axial load 1 N", "axial load 100 kN", "radial load 5 x axial, balls unloaded", "3 balls", "clearance 20 um", "tilt free",
    "lift-off: rotating 3000 N at 1000 N axial",
)  # fmt: skip
PENALTIES = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)

POINTS: Changes = {
    "bodies.kind": "condensed", "contact.discretisation": "nodal", "mesh": {"kind": "structured", "nodes_per_semi_axis": 2}, **STATIC,
}  # fmt: skip
#: Scenes at rest whose contacts lie inside the grooves.
STILL: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0]}),
    ("3 balls", {"bearing.ball_count": 3}),
    ("conformity 0.60", {"bearing.conformity_inner": 0.6, "bearing.conformity_outer": 0.6}),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
#: Scenes at rest that a user must be told something about.
WARNED: tuple[tuple[str, Changes, str, str], ...] = (
    ("axial load 100 kN", {"load.axial": 1e5}, "groove's edge", "contacts are cut off by the shoulder"),
    (
        "conformity 0.501", {"bearing.conformity_inner": 0.501, "bearing.conformity_outer": 0.501},
        "groove's edge", "the ellipse is longer than the groove",
    ),
    ("rubber balls in ceramic rings", _RUBBER_BALLS, "groove's edge", "the balls fill the grooves"),
    ("Poisson's ratio 0.4999", NEARLY_INCOMPRESSIBLE, "elements lock", "contacts are nearly twice too stiff"),
)  # fmt: skip

#: Three balls on some four thousand elements, contacts narrower than an element: every path, no accuracy.
TINY: Tables = {
    "title": "three balls on few elements",
    "bearing": {"preset": "B7206C", "ball_count": 3},
    "bodies": {"kind": "elastic", "formulation": "one_point"},
    "mesh": {
        "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 12, "growth": 3.0,
        "patch": 0.5, "ball_load": 300.0,
    },
    "load": {"axial": 250.0},
    "rotor": {"mass": 0.5},
    "contact": {"kind": "hertz", "discretisation": "nodal"},
}  # fmt: skip
ELASTIC_POINTS: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("axial load 100 kN", {"load.axial": 1e5}),
    ("rubber balls in ceramic rings", _RUBBER_BALLS),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("Poisson's ratio 0.4999", NEARLY_INCOMPRESSIBLE),
)
#: 2688 elements for the base scene's twelve balls.
COARSE: Changes = {
    "bodies": {"kind": "elastic", "formulation": "incompatible"},
    "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 24}, **STATIC,
}  # fmt: skip
RESULTANTS: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("3 balls", {"bearing.ball_count": 3, "load.axial": 250.0}),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
#: 15 000 r/min, a force that acts at once.
EXCITED: Changes = {"excitation.kind": "bidirectional", "excitation.speed_rpm": 15000.0, **force(60.0)}

#: name, changes, words of the message, why there is no answer.
REFUSALS: tuple[tuple[str, Changes, str, str], ...] = (
    ("no load", {"load.axial": 0.0}, "nothing loads the bearing", "every motion is free"),
    (
        "two balls on the line of the load",
        {"bearing.ball_count": 2, "bearing.preset": "B7206C", "supports.tilt": "free", "excitation": None},
        "singular",
        "the ring turns freely about the line of its two balls",
    ),
    (
        "explicit step above the limit",
        {"integrator.kind": "central_difference", "integrator.steps_per_turn": 12},
        "above the stable limit",
        "it is refused before it blows up",
    ),
    (
        "unilateral law on rigid bodies",
        {"contact.kind": "unilateral"},
        "supports 'nodal'",
        "it is no function of one approach",
    ),
    (
        "steady orbit with friction",
        {"integrator.kind": "periodic", "contact.friction": 0.3},
        "depends on how the motion began",
        "sticking has a memory",
    ),
    ("orbiting balls at rest", {"kinematics.orbiting": True, "kinematics.spin_speed_rpm": 0.0}, "needs a spin speed", "nothing turns"),
    (
        "a record of 19 GiB",
        {"integrator.turns": 10_000_000},
        "would take",
        "it is refused before it fills the memory",
    ),
    (
        "penalty stiffer than elastic bodies allow",
        {"bodies.kind": "condensed", "contact.kind": "penalty", "load.axial": 1e5},
        "is stiffer than elastic bodies allow",
        "what finite elements take off a contact's compliance would leave none",
    ),
    ("Poisson's ratio 0.5", {"bearing.rings": {"poisson": 0.5}}, "poisson", "the moduli are infinite"),
    ("no mass", {**_BARE, **_B7206C, "rotor.mass": 0.0}, "nothing has mass", "no acceleration is defined"),
)  # fmt: skip

#: name, changes, words of the warning, what it is about.
WARNINGS: tuple[tuple[str, Changes, str, str], ...] = (
    (
        "axial load that unseats the bearing",
        {"load.axial": -1000.0, **STATIC, "excitation": None},
        "the bearing unseats",
        "grooves without an end would hold the ring on the other side",
    ),
    (
        "contact ellipse beyond the groove's edge",
        {"load.axial": 1e5, "excitation": None},
        "beyond the groove's edge",
        "the ellipse is cut off there in reality",
    ),
)
