"""The catalogue of stiff and extreme cases: data.  What a case measures is in the modules that it names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from raceway.errors import SceneError
from raceway.registry import Registry
from raceway.studies.stability_case import Case
from raceway.studies.stability_systems import BASE, UNDAMPED, pair_laws, transient

Changes = dict[str, Any]


def _force(newton: float) -> Changes:
    """A rotating force that is the same at every speed."""
    return {"excitation.amplitude": "constant", "excitation.force": newton}


#: Geometry without the dimensions that give the inner ring a mass of its own.
_BARE = {"bearing.bore": None, "bearing.outer_diameter": None, "bearing.width": None, "bearing.preset": None}
_B7206C = {
    "bearing.ball_diameter": 9.525e-3, "bearing.pitch_diameter": 46e-3, "bearing.ball_count": 12,
    "bearing.conformity_inner": 0.522, "bearing.conformity_outer": 0.522, "bearing.contact_angle_deg": 15.0,
}  # fmt: skip
_RUBBER, _CERAMIC = {"young": 1e7, "poisson": 0.49, "density": 1100.0}, {"young": 310e9, "poisson": 0.26, "density": 3200.0}
_STATIC: Changes = {"kinematics.ball_inertia": False}

#: name, what changes in the base, whether the closed form of an axial load holds, and how the motion is judged:
#: "orbit" by the steady orbit, "slow" by the series of equilibria, "energy" by its balance where no orbit is steady, "" for
#: the equilibrium alone.
SCENES: tuple[tuple[str, Changes, bool, str], ...] = (
    ("base", {}, True, "orbit"),
    ("axial load 1 N", {"load.axial": 1.0, **_force(0.1), **_STATIC}, False, "orbit"),
    ("axial load 1 N under 50 N rotating: rattling", {"load.axial": 1.0, **_force(50.0), **_STATIC}, False, "energy"),
    ("axial load 100 kN", {"load.axial": 1e5, **_force(400.0)}, True, "orbit"),
    ("speed 1 r/min", {"excitation.speed_rpm": 1.0, **_force(400.0), "integrator.turns": 3}, True, "slow"),
    ("speed 200 000 r/min", {"excitation.speed_rpm": 2e5, **_force(100.0)}, False, "orbit"),
    ("radial load = axial", {"load.radial": [1000.0, 0.0], **_force(100.0)}, False, "orbit"),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0], **_force(100.0)}, False, "orbit"),
    ("radial load 20 x axial", {"load.radial": [20000.0, 0.0], **_force(300.0)}, False, "orbit"),
    ("radial load 50 x axial", {"load.radial": [50000.0, 0.0], **_force(300.0)}, False, "orbit"),
    ("lift-off: rotating 3000 N at 1000 N axial", _force(3000.0), True, "energy"),
    ("3 balls", {"bearing.ball_count": 3, **_force(100.0)}, True, "orbit"),
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
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 50e-6, "load.axial": 20.0, **_force(200.0), **_STATIC},
        False, "energy",
    ),
    (
        "clearance 20 um",
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 20e-6, **_force(100.0)},
        True, "orbit",
    ),
    ("interference 5 um", {"kinematics.radial_expansion": 5e-6, **_force(100.0)}, False, "orbit"),
    ("interference 20 um", {"kinematics.radial_expansion": 20e-6, **_force(100.0)}, False, "orbit"),
    ("Poisson's ratio 0.4999", {"bearing.rings": {"poisson": 0.4999}, "bearing.balls": {"poisson": 0.4999}}, True, "orbit"),
    ("rubber balls in ceramic rings", {"bearing.rings": _CERAMIC, "bearing.balls": _RUBBER, "load.axial": 10.0, **_force(1.0), "rotor.mass": 0.1, **_STATIC}, True, "orbit"),
    ("ceramic balls in steel rings", {"bearing.balls": _CERAMIC}, True, "orbit"),
    ("friction 0.3", {"contact.friction": 0.3, **_force(100.0)}, True, "energy"),
    ("friction 1.0", {"contact.friction": 1.0, **_force(100.0)}, True, "energy"),
    ("gyroscopic moments, 40 000 r/min", {"kinematics.gyroscopic": "outer_race", "excitation.speed_rpm": 4e4, **_force(100.0)}, False, "orbit"),
    ("orbiting balls", {"kinematics.orbiting": True}, True, "orbit"),
    ("rotor of 1 g", {**_BARE, **_B7206C, "rotor.mass": 1e-3}, True, "orbit"),
    ("rotor of 10 t", {"rotor.mass": 1e4}, True, "orbit"),
    ("tilt free", {"supports.tilt": "free", **_force(100.0)}, False, "orbit"),
    ("tilt free, radial load = axial", {"supports.tilt": "free", "load.radial": [1000.0, 0.0], **_force(50.0)}, False, "orbit"),
    ("no damping", dict(UNDAMPED), True, "orbit"),
)  # fmt: skip

#: Those that are run with elastic rings and balls, too.
CONDENSED = (
    "base", "axial load 1 N", "axial load 100 kN", "radial load 5 x axial, balls unloaded", "3 balls", "conformity 0.501",
    "lift-off: rotating 3000 N at 1000 N axial", "Poisson's ratio 0.4999", "rubber balls in ceramic rings",
    "ceramic balls in steel rings", "friction 0.3", "tilt free",
)  # fmt: skip
#: A penalty that is scaled at small loads is stiffer than what finite elements would take off it; refused, see REFUSALS.
TOO_STIFF = (("axial load 100 kN", "penalty"), ("rubber balls in ceramic rings", "penalty"))
PENALTIES = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)

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
        {"load.axial": -1000.0, **_STATIC, "excitation": None},
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


def catalogue(registry: Registry, tables: Mapping[str, Any] | None = None) -> tuple[Case, ...]:
    """All cases; of a scene those that any scene can be put through.

    Parameters
    ----------
    tables : plain tables of a user's scene; the base scene and the whole catalogue when None

    Raises
    ------
    SceneError
        A scene whose contacts are surface points.
    """
    base = dict(tables) if tables is not None else BASE
    if base.get("contact", {}).get("discretisation") == "nodal":
        why = "the cases move bearings through a million steps, which takes forces of whole contacts: use 'resultant'"
        raise SceneError.at("contact.discretisation", "nodal", why)
    cases = [*_limits(base, registry), *_orbits(base, registry, tables is None), *_energy(base, registry, tables is None)]
    cases += _penalties(base, registry)
    if tables is None:
        cases += [*_scenes(base, registry), *_without_penetration(base, registry), *_refusals(base), *_elements()]
    return tuple(cases)


def _limits(base: Changes, registry: Registry) -> Iterator[Case]:
    for name in transient(registry):
        yield Case("steps around the limit, linear", "stability_limits:linear", {"tables": base, "integrator": name}, 0.5)
        for law in pair_laws(registry):
            for tilt in ("locked", "free"):
                arguments = {
                    "tables": base, "integrator": name, "changes": {"contact.kind": law, "supports.tilt": tilt},
                    "shown": {"law": law, "tilt": tilt},
                }  # fmt: skip
                yield Case(
                    "steps around the limit, small motions of the bearing", "stability_limits:small_motions", arguments, 0.5
                )


def _orbits(base: Changes, registry: Registry, whole: bool) -> Iterator[Case]:
    """Orbits from small to lift-off; a user's scene has its own."""
    places = [
        (axial, force, tilt)
        for axial, force, tilt in (
            (400.0, 100.0, "locked"), (400.0, 400.0, "locked"), (400.0, 800.0, "locked"), (400.0, 1500.0, "locked"),
            (1000.0, 3000.0, "locked"), (1000.0, 6000.0, "locked"), (400.0, 400.0, "free"), (400.0, 800.0, "free"),
        )
    ]  # fmt: skip
    for name in transient(registry):
        for law in pair_laws(registry):
            for axial, force, tilt in places if whole else [(None, None, None)]:
                changes: Changes = {"contact.kind": law}
                shown: Changes = {"law": law}
                if axial is not None and force is not None:
                    changes |= {"load.axial": axial, **_force(force), "supports.tilt": tilt}
                    shown |= {"axial": axial, "force": force, "tilt": tilt}
                arguments = {"tables": base, "integrator": name, "changes": changes, "shown": shown}
                yield Case("orbit at the safe limit", "stability_limits:orbit_at_the_safe_limit", arguments, 0.3)


def _energy(base: Changes, registry: Registry, whole: bool) -> Iterator[Case]:
    steps = 1_000_000 if whole else 100_000
    for law in pair_laws(registry):
        common: Changes = {"tables": base, "changes": {"contact.kind": law}, "shown": {"law": law}}
        for name in transient(registry):
            one = {**common, "integrator": name}
            for factor, amplitude in ((0.1, 0.03), (0.02, 1.5)):
                arguments = {**one, "steps": steps, "factor": factor, "amplitude": amplitude}
                yield Case("undamped steps", "stability_energy:million_steps", arguments, 6e-6 * steps)
            if not whole:
                continue
            for speed in (0.01, 1.0, 10.0):
                yield Case("impact", "stability_energy:impact", {**one, "speed": speed, "steps": 100}, 0.2)
            for depth in (1e-4, 5e-4):
                yield Case("deep initial penetration", "stability_energy:deep_penetration", {**one, "depth": depth}, 0.3)
        if whole:
            far = {**common, "guesses": [1e-3, 5e-3, 5e-2, -1e-3, -5e-3]}
            yield Case("equilibrium from afar", "stability_energy:settled_from_afar", far, 0.2)
            for name, options, step, chatters in _CHATTER:
                if name in transient(registry):
                    rest = {**common, "integrator": name, "options": options, "step": step, "chatters": chatters}
                    yield Case("chatter", "stability_energy:chatter", rest, 0.1)


#: integrator, options, step over the contact's period, whether it chatters.
_CHATTER: tuple[tuple[str, Changes, float, bool], ...] = (
    ("newmark", {}, 1.0, True),
    ("newmark", {}, 0.05, False),
    ("generalized_alpha", {"rho_infinity": 0.5}, 1.0, False),
    ("generalized_alpha", {"rho_infinity": 0.0}, 1.0, False),
    ("central_difference", {}, 0.05, False),
)


def _penalties(base: Changes, registry: Registry) -> Iterator[Case]:
    if "penalty" not in pair_laws(registry):
        return
    for factor in PENALTIES:
        arguments = {
            "tables": base, "changes": {"contact.kind": "penalty"}, "shown": {"law": "penalty", "penalty / default": factor},
            "penalty_factor": factor, "judge": "orbit" if "excitation" in base else "",
        }  # fmt: skip
        yield Case("penalty", "stability_scenes:extreme", arguments, 1.0)


def _scenes(base: Changes, registry: Registry) -> Iterator[Case]:
    for name, changes, closed, judge in SCENES:
        for law in pair_laws(registry):
            arguments: Changes = {
                "tables": base, "changes": {**changes, "contact.kind": law}, "shown": {"law": law}, "closed_form": closed,
                "judge": judge,
            }  # fmt: skip
            yield Case(name, "stability_scenes:extreme", arguments, 1.5)
            if name in CONDENSED and (name, law) not in TOO_STIFF:
                elastic: Changes = {
                    **arguments, "changes": {**arguments["changes"], "bodies.kind": "condensed"}, "closed_form": False,
                    "shown": {"law": law, "bodies": "condensed"},
                }  # fmt: skip
                yield Case(name, "stability_scenes:extreme", elastic, 8.0)


def _without_penetration(base: Changes, registry: Registry) -> Iterator[Case]:
    """Laws for surface points only, on elastic bodies: few points and few steps, as each takes a tenth of a second."""
    entries: list[Any] = [entry for entry in registry.all() if entry.kind == "contact_law"]
    for law in (e.name for e in entries if e.plugin.discretisations == {"nodal"}):
        same: Changes = {"bodies.kind": "condensed", **_STATIC}
        changes: Changes = {
            "contact.kind": law, "contact.discretisation": "nodal", "integrator.turns": 1, "integrator.steps_per_turn": 40,
            "mesh": {"kind": "structured", "nodes_per_semi_axis": 2},
        }  # fmt: skip
        for name in transient(registry):
            shown = {"law": law, "bodies": "condensed", "integrator": name}
            arguments: Changes = {"tables": base, "integrator": name, "shown": shown, "same": same, "changes": changes}
            if name in _THROUGH_POINTS:
                yield Case("contact without penetration", "stability_scenes:points", arguments, 12.0)
                continue
            arguments["changes"] = {**same, **changes, "integrator.kind": name}
            arguments |= {"words": "through too many steps", "reason": "a step takes a tenth of a second"}
            yield Case("contact without penetration", "stability_scenes:refusal", arguments, 0.5)


#: Integrators that take surface points through a turn.
_THROUGH_POINTS = ("newmark",)


def _refusals(base: Changes) -> Iterator[Case]:
    for name, changes, words, reason in REFUSALS:
        arguments = {"tables": base, "changes": changes, "words": words, "reason": reason, "shown": {}}
        yield Case(name, "stability_scenes:refusal", arguments, 0.2)
    for name, changes, words, reason in WARNINGS:
        arguments = {"tables": base, "changes": changes, "words": words, "reason": reason, "shown": {}}
        yield Case(name, "stability_scenes:warning", arguments, 0.2)


def _elements() -> Iterator[Case]:
    for aspect in (1, 20, 200):
        yield Case("slender elements, explicit steps", "stability_elements:slender_steps", {"aspect": aspect}, 2.0)
        for poisson, young in ((0.29, 212e9), (0.4999, 1e7)):
            arguments = {"aspect": aspect, "poisson": poisson, "young": young}
            yield Case("slender elements, tension", "stability_elements:slender_bar", arguments, 1.0)
    yield Case("nearly incompressible cantilever", "stability_elements:locking", {}, 2.0)
    yield Case("rubber on ceramic, elements", "stability_elements:soft_on_hard", {}, 1.0)
    yield Case("elements without a volume", "stability_elements:bad_elements", {}, 0.5)
