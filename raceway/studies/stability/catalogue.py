"""The catalogue of stiff and extreme cases: extreme scenes, penalties, surface points, elastic bodies, refusals and warnings.

What a case measures is in the module that its ``measure`` names.
"""

from __future__ import annotations

from collections.abc import Iterator

import attrs

from raceway.errors import SceneError
from raceway.framework.duties import line_contact
from raceway.framework.registry import Entry, Registry
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.stability.study import Case

#: The article's bearing, load and force; every case that names no other scene changes this one.
BASE: Tables = {
    "title": "B7206C, 1 kN axial, rig unbalance at 12 000 r/min",
    "bearing": {"preset": "B7206C"}, "rotor": {"mass": 2.0}, "load": {"axial": 1000.0}, "contact": {"damping": 0.001},
    "excitation": {
        "kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 6.39e-4, "load_share": 0.5, "reference_speed_rpm": 10980.0,
    },
    "kinematics": {"gyroscopic": "none", "ring_growth": False}, "integrator": {"kind": "newmark", "turns": 12},
}  # fmt: skip
#: Nothing that loses energy.
UNDAMPED = {"contact.damping": 0.0, "rotor.damping": 0.0, "contact.friction": 0.0}


def _force(newton: float) -> Tables:
    """A rotating force that is the same at every speed."""
    return {"excitation.amplitude": "constant", "excitation.force": newton}


#: Geometry without the dimensions that give the inner ring a mass of its own.
_BARE = {"bearing.bore": None, "bearing.outer_diameter": None, "bearing.width": None, "bearing.preset": None}
_B7206C = {
    "bearing.ball_diameter": 9.525e-3, "bearing.pitch_diameter": 46e-3, "bearing.ball_count": 12,
    "bearing.conformity_inner": 0.522, "bearing.conformity_outer": 0.522, "bearing.contact_angle_deg": 15.0,
}  # fmt: skip
_RUBBER, _CERAMIC = {"young": 1e7, "poisson": 0.49, "density": 1100.0}, {"young": 310e9, "poisson": 0.26, "density": 3200.0}
_NEARLY_INCOMPRESSIBLE: Tables = {"bearing.rings": {"poisson": 0.4999}, "bearing.balls": {"poisson": 0.4999}}
_RUBBER_BALLS: Tables = {"bearing.rings": _CERAMIC, "bearing.balls": _RUBBER, "load.axial": 10.0}
STATIC: Tables = {"kinematics.ball_inertia": False}
#: The whole force from the first step on: while a force grows, energy is not balanced.
_SUDDEN: Tables = {"integrator.start": "static"}

#: name, what changes in the base, whether the closed form of an axial load holds, and how the motion is judged:
#: "orbit" by the steady orbit, "slow" by the series of equilibria, "finer" by finer steps and the balance of energy where no
#: orbit is steady or friction remembers, "" for the equilibrium alone.
SCENES: tuple[tuple[str, Tables, bool, str], ...] = (
    ("base", {}, True, "orbit"),
    ("axial load 1 N", {"load.axial": 1.0, **_force(0.1), **STATIC}, False, "orbit"),
    ("axial load 1 N under 50 N rotating: rattling", {"load.axial": 1.0, **_force(50.0), **STATIC, **_SUDDEN}, False, "finer"),
    ("axial load 100 kN", {"load.axial": 1e5, **_force(400.0)}, True, "orbit"),
    ("speed 1 r/min", {"excitation.speed_rpm": 1.0, **_force(400.0), "integrator.turns": 3}, True, "slow"),
    ("speed 200 000 r/min", {"excitation.speed_rpm": 2e5, **_force(100.0)}, False, "orbit"),
    ("radial load = axial", {"load.radial": [1000.0, 0.0], **_force(100.0)}, False, "orbit"),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0], **_force(100.0)}, False, "orbit"),
    ("radial load 20 x axial", {"load.radial": [20000.0, 0.0], **_force(300.0)}, False, "orbit"),
    ("radial load 50 x axial", {"load.radial": [50000.0, 0.0], **_force(300.0)}, False, "orbit"),
    ("lift-off: rotating 3000 N at 1000 N axial", _force(3000.0), True, "orbit"),
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
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 50e-6, "load.axial": 20.0, **_force(200.0), **STATIC},
        False, "finer",
    ),
    (
        "clearance 20 um",
        {**_BARE, **_B7206C, "bearing.contact_angle_deg": None, "bearing.radial_clearance": 20e-6, **_force(100.0)},
        True, "orbit",
    ),
    ("interference 5 um", {"kinematics.radial_expansion": 5e-6, **_force(100.0)}, False, "orbit"),
    ("interference 20 um", {"kinematics.radial_expansion": 20e-6, **_force(100.0)}, False, "orbit"),
    ("Poisson's ratio 0.4999", _NEARLY_INCOMPRESSIBLE, True, "orbit"),
    ("rubber balls in ceramic rings", {**_RUBBER_BALLS, **_force(1.0), "rotor.mass": 0.1, **STATIC}, True, "orbit"),
    ("ceramic balls in steel rings", {"bearing.balls": _CERAMIC}, True, "orbit"),
    ("friction 0.3", {"contact.friction": 0.3, **_force(100.0)}, True, "finer"),
    ("friction 1.0", {"contact.friction": 1.0, **_force(100.0)}, True, "finer"),
    ("gyroscopic moments, 40 000 r/min", {"kinematics.gyroscopic": "outer_race", "excitation.speed_rpm": 4e4, **_force(100.0)}, False, "orbit"),
    ("orbiting balls", {"kinematics.orbiting": True}, True, "orbit"),
    ("rotor of 1 g", {**_BARE, **_B7206C, "rotor.mass": 1e-3}, True, "orbit"),
    ("rotor of 10 t", {"rotor.mass": 1e4}, True, "orbit"),
    ("tilt free", {"supports.tilt": "free", **_force(100.0)}, False, "orbit"),
    ("tilt free, radial load = axial", {"supports.tilt": "free", "load.radial": [1000.0, 0.0], **_force(50.0)}, False, "orbit"),
    ("no damping", dict(UNDAMPED), True, "orbit"),
)  # fmt: skip

#: Those that are run with elastic rings and balls, too.
_CONDENSED = (
    "base", "axial load 1 N", "axial load 100 kN", "radial load 5 x axial, balls unloaded", "3 balls", "conformity 0.501",
    "lift-off: rotating 3000 N at 1000 N axial", "Poisson's ratio 0.4999", "rubber balls in ceramic rings",
    "ceramic balls in steel rings", "friction 0.3", "tilt free",
)  # fmt: skip
#: Those that are run unless all is asked for.
_QUICK = (
    "base", "axial load 1 N", "axial load 100 kN", "radial load 5 x axial, balls unloaded", "3 balls", "clearance 20 um", "tilt free",
    "lift-off: rotating 3000 N at 1000 N axial",
)  # fmt: skip
_PENALTIES = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)

_POINTS: Tables = {
    "bodies.kind": "condensed", "contact.discretisation": "nodal", "mesh": {"kind": "structured", "nodes_per_semi_axis": 2}, **STATIC,
}  # fmt: skip
#: Scenes at rest whose contacts lie inside the grooves.
_STILL: tuple[tuple[str, Tables], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0]}),
    ("3 balls", {"bearing.ball_count": 3}),
    ("conformity 0.60", {"bearing.conformity_inner": 0.6, "bearing.conformity_outer": 0.6}),
    ("ceramic balls in steel rings", {"bearing.balls": _CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
#: Scenes at rest that a user must be told something about.
_WARNED: tuple[tuple[str, Tables, str, str], ...] = (
    ("axial load 100 kN", {"load.axial": 1e5}, "groove's edge", "contacts are cut off by the shoulder"),
    (
        "conformity 0.501", {"bearing.conformity_inner": 0.501, "bearing.conformity_outer": 0.501},
        "groove's edge", "the ellipse is longer than the groove",
    ),
    ("rubber balls in ceramic rings", _RUBBER_BALLS, "groove's edge", "the balls fill the grooves"),
    ("Poisson's ratio 0.4999", _NEARLY_INCOMPRESSIBLE, "elements lock", "contacts are nearly twice too stiff"),
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
_ELASTIC_POINTS: tuple[tuple[str, Tables], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("axial load 100 kN", {"load.axial": 1e5}),
    ("rubber balls in ceramic rings", _RUBBER_BALLS),
    ("ceramic balls in steel rings", {"bearing.balls": _CERAMIC}),
    ("Poisson's ratio 0.4999", _NEARLY_INCOMPRESSIBLE),
)
#: 2688 elements for the base scene's twelve balls.
COARSE: Tables = {
    "bodies": {"kind": "elastic", "formulation": "incompatible"},
    "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 24}, **STATIC,
}  # fmt: skip
_RESULTANTS: tuple[tuple[str, Tables], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("3 balls", {"bearing.ball_count": 3, "load.axial": 250.0}),
    ("ceramic balls in steel rings", {"bearing.balls": _CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
#: 15 000 r/min, a force that acts at once.
_EXCITED: Tables = {"excitation.kind": "bidirectional", "excitation.speed_rpm": 15000.0, **_force(60.0)}

#: name, changes, words of the message, why there is no answer.
_REFUSALS: tuple[tuple[str, Tables, str, str], ...] = (
    ("no load", {"load.axial": 0.0}, "no load acts", "all motions are free"),
    (
        "two balls on the line of the load",
        {"bearing.ball_count": 2, "bearing.preset": "B7206C", "supports.tilt": "free", "excitation": None},
        "singular", "the ring turns freely about the line of its two balls",
    ),
    (
        "explicit step above the limit", {"integrator.kind": "central_difference", "integrator.steps_per_turn": 12},
        "above the stable limit", "it is refused before it blows up",
    ),
    ("unilateral law on rigid bodies", {"contact.kind": "unilateral"}, "supports 'nodal'", "it is no function of one approach"),
    (
        "steady orbit with friction", {"integrator.kind": "periodic", "contact.friction": 0.3},
        "depends on the start of the motion", "sticking has a memory",
    ),
    ("orbiting balls at rest", {"kinematics.orbiting": True, "kinematics.spin_speed_rpm": 0.0}, "needs a spin speed", "nothing turns"),
    ("a record of 19 GiB", {"integrator.turns": 10_000_000}, "would take", "it is refused before it fills the memory"),
    (
        "penalty stiffer than elastic bodies allow", {"bodies.kind": "condensed", "contact.kind": "penalty", "load.axial": 1e5},
        "is stiffer than elastic bodies allow", "what finite elements take off a contact's compliance would leave none",
    ),
    ("Poisson's ratio 0.5", {"bearing.rings": {"poisson": 0.5}}, "poisson", "the moduli are infinite"),
    ("no mass", {**_BARE, **_B7206C, "rotor.mass": 0.0}, "moving mass is 0", "no acceleration is defined"),
)  # fmt: skip
#: name, changes, words of the warning, what it is about.
_WARNINGS: tuple[tuple[str, Tables, str, str], ...] = (
    (
        "axial load that opens the bearing", {"load.axial": -1000.0, **STATIC, "excitation": None},
        "the bearing loses axial contact", "grooves without an end would hold the ring on the other side",
    ),
    (
        "contact ellipse beyond the groove's edge", {"load.axial": 1e5, "excitation": None},
        "beyond the groove's edge", "the ellipse is cut off there in reality",
    ),
)  # fmt: skip

#: Axial load, rotating force [N] and tilt of orbits from small to lift-off, and whether they are quick ones.
_ORBITS = (
    (400.0, 100.0, "locked", False), (400.0, 400.0, "locked", False), (400.0, 800.0, "locked", False),
    (400.0, 1500.0, "locked", True), (1000.0, 3000.0, "locked", False), (1000.0, 6000.0, "locked", False),
    (400.0, 400.0, "free", False), (400.0, 800.0, "free", False),
)  # fmt: skip
#: Step over the limit and amplitude over the approach of undamped steps: contacts stay closed, or open.
_UNDAMPED = ((0.1, 0.03), (0.02, 1.5))
#: integrator, options, step over the contact's period, whether it may chatter: the law decides.
_CHATTER: tuple[tuple[str, Tables, float, bool], ...] = (
    ("newmark", {}, 1.0, True), ("newmark", {}, 0.05, False), ("generalized_alpha", {"rho_infinity": 0.5}, 1.0, False),
    ("generalized_alpha", {"rho_infinity": 0.0}, 1.0, False), ("central_difference", {}, 0.05, False),
)  # fmt: skip
_AT_REST = "scenes:condensed_at_rest"


def transient_integrators(registry: Registry) -> list[Entry]:
    """Integrators that march through time with inertia.  One that finds a steady orbit instead says ``steady = True``."""
    integrators = [entry for entry in registry.all() if entry.kind == "integrator"]
    return [entry for entry in integrators if entry.plugin.inertial and not entry.plugin.steady]


def transient(registry: Registry) -> list[str]:
    """Names of the integrators that march through time with inertia."""
    return [entry.name for entry in transient_integrators(registry)]


def _laws_with(registry: Registry, *discretisations: str) -> list[str]:
    """Names of the laws of ball contacts that know these discretisations."""
    laws = [entry for entry in registry.all() if entry.kind == "contact_law" and not line_contact(entry.plugin)]
    return [law.name for law in laws if set(discretisations) <= set(law.plugin.discretisations)]


def _with_law(name: str, registry: Registry) -> Tables:
    """The changes that give a scene a law: a law that needs options has those of its first example."""
    plugin = registry.find("contact_law", name).plugin
    try:
        complete = getattr(plugin(), "known", True)  # films need an oil
    except (TypeError, ValueError):
        complete = False
    if not complete:
        first = plugin.examples()[0]
        fields = [field for field in attrs.fields(plugin) if getattr(first, field.name) != field.default]
        return {"contact.kind": name, **{f"contact.{field.name}": getattr(first, field.name) for field in fields}}
    return {"contact.kind": name}


def catalogue(registry: Registry, tables: ReadTables | None = None) -> tuple[Case, ...]:
    """All cases; of a scene those that any scene can be put through.

    Parameters
    ----------
    tables : plain tables of a user's scene; the base scene and the full catalogue when None

    Raises
    ------
    SceneError
        A scene whose contacts are surface points.
    """
    base = dict(tables) if tables is not None else BASE
    if base.get("contact", {}).get("discretisation") == "nodal":
        why = "the cases move bearings through a million steps, which takes forces of whole contacts: use 'resultant'"
        raise SceneError.at("contact.discretisation", "nodal", why)
    cases = _any_scene(base, registry, own=tables is not None)
    if tables is not None:
        return tuple(cases)
    parts = (_contacts(base, registry), _scenes(base, registry), _points(base, registry), _elastic(base, registry))
    return (*cases, *(case for part in parts for case in part), *_messages(base), *_elements())


def _any_scene(base: Tables, registry: Registry, own: bool) -> Iterator[Case]:
    """Steps around the limit, orbits, undamped steps, penalties; ``own``: of a user's scene, whose orbit is its own."""
    laws = _laws_with(registry, "resultant")
    for name in transient(registry):
        by_name: Tables = {"tables": base, "integrator": name}
        yield Case("steps around the limit, linear", "motions:linear", {"integrator": name}, by_name)
        for law in laws:
            setting, changes = {"integrator": name, "law": law}, _with_law(law, registry)
            arguments = {**by_name, "changes": changes}
            for tilt in ("locked", "free"):
                tilted = {**arguments, "changes": {**changes, "supports.tilt": tilt}}
                title = "steps around the limit, small motions of the bearing"
                yield Case(title, "motions:small_motions", {**setting, "tilt": tilt}, tilted)
            orbit = "orbit at the safe limit", "motions:orbit_at_the_safe_limit"
            if own:
                yield Case(*orbit, setting, arguments)
            for axial, newton, tilt, quick in () if own else _ORBITS:
                orbiting = {**changes, "load.axial": axial, **_force(newton), "supports.tilt": tilt}
                shown = {**setting, "axial": axial, "force": newton, "tilt": tilt}
                yield Case(*orbit, shown, {**arguments, "changes": orbiting}, quick)
            for steps in (100_000,) if own else (100_000, 1_000_000):
                for factor, amplitude in _UNDAMPED:
                    undamped = {**arguments, "steps": steps, "factor": factor, "amplitude": amplitude}
                    yield Case("undamped steps", "motions:many_steps", setting, undamped, steps == 100_000)
    judge = "" if "excitation" not in base else "any" if own else "orbit"
    for factor in _PENALTIES if "penalty" in laws else ():
        arguments = {"tables": base, "changes": {"contact.kind": "penalty"}, "penalty_factor": factor, "judge": judge}
        shown = {"law": "penalty", "penalty / default": factor}
        yield Case("penalty", "scenes:extreme", shown, arguments, own or factor in (1e-3, 1e3))


def _contacts(base: Tables, registry: Registry) -> Iterator[Case]:
    """Impacts, deep penetrations, equilibria from afar, chatter."""
    names = transient(registry)
    for law in _laws_with(registry, "resultant"):
        arguments: Tables = {"tables": base, "changes": _with_law(law, registry)}
        for name in names:
            moved, setting = {**arguments, "integrator": name}, {"integrator": name, "law": law}
            for speed in (0.01, 1.0, 10.0):
                yield Case("impact", "motions:impact", setting, {**moved, "speed": speed, "steps": 100})
            for depth in (1e-4, 5e-4):
                yield Case("deep initial penetration", "motions:deep_penetration", setting, {**moved, "depth": depth})
        guesses = [1e-3, 5e-3, 5e-2, -1e-3, -5e-3]
        yield Case("equilibrium from afar", "motions:settled_from_afar", {"law": law}, {**arguments, "guesses": guesses})
        for name, options, step, chatters in _CHATTER:
            if name in names:
                falling = {**arguments, "integrator": name, "options": options, "step": step, "chatters": chatters}
                yield Case("chatter", "motions:chatter", {"integrator": name, "law": law}, falling)


def _scenes(base: Tables, registry: Registry) -> Iterator[Case]:
    for name, changes, closed, judge in SCENES:
        if closed:
            yield Case(f"Hertz' contacts: {name}", "scenes:hertz_factor", {}, {"tables": base, "changes": changes})
        for law in _laws_with(registry, "resultant"):
            lawful = {**changes, **_with_law(law, registry)}
            arguments: Tables = {"tables": base, "judge": judge, "changes": lawful}
            yield Case(name, "scenes:extreme", {"law": law}, {**arguments, "closed_form": closed}, name in _QUICK)
            if name in _CONDENSED:
                arguments |= {"changes": {**lawful, "bodies.kind": "condensed"}, "may_be_too_stiff": True}
                yield Case(name, "scenes:extreme", {"law": law, "bodies": "condensed"}, arguments, False)


def _points(base: Tables, registry: Registry) -> Iterator[Case]:
    """Condensed bodies with every law that surface points can have."""
    turn: Tables = {"integrator.turns": 1, "integrator.steps_per_turn": 40}
    for law in _laws_with(registry, "nodal"):

        def case(name: str, measure: str, changes: Tables, shown: Tables | None = None, law: str = law, **more: str) -> Case:
            setting = {"law": law, "bodies": "condensed, points", **(shown or {})}
            arguments = {"tables": base, "changes": {**_POINTS, **changes, "contact.kind": law}, **more}
            return Case(f"surface points: {name}", measure, setting, arguments, measure == _AT_REST and name == "base")

        for name, changes in _STILL:
            yield case(name, _AT_REST, changes)
        for name, changes, words, reason in _WARNED:
            yield case(name, "scenes:warning", {**changes, "excitation": None}, words=words, reason=reason)
        for name in transient(registry):
            shown = {"integrator": name}
            if registry.find("integrator", name).plugin.implicit:
                yield case("a turn", "scenes:turn", turn, shown, integrator=name)
            else:
                words, reason = "needs too many steps", "a step takes a tenth of a second"
                yield case("a turn", "scenes:refusal", {**turn, "integrator.kind": name}, shown, words=words, reason=reason)


def _elastic(base: Tables, registry: Registry) -> Iterator[Case]:
    """One force a contact and pressures at points, with every law that both can have."""

    def case(
        name: str, measure: str, changes: Tables, bodies: str = "points", tables: Tables = TINY, law: str = "", **more: str
    ) -> Case:  # fmt: skip
        setting = ({"law": law} if law else {}) | {"bodies": f"elastic, {bodies}"}
        setting |= {"integrator": more["integrator"]} if "integrator" in more else {}
        changes = {**changes, "contact.kind": law} if law else changes
        return Case(f"elastic bodies: {name}", measure, setting, {"tables": tables, "changes": changes, **more}, False)

    for law in _laws_with(registry, "nodal", "resultant"):
        for name, changes in _RESULTANTS if law == "hertz" else _RESULTANTS[:1]:
            yield case(name, "scenes:calibrated_at_rest", {**changes, "excitation": None}, "resultants", base, law)
        for name, changes in _ELASTIC_POINTS if law == "hertz" else _ELASTIC_POINTS[:1]:
            yield case(name, "scenes:points_at_rest", changes, law=law)
        words = "the displacement depend on the mesh"
        reason = "an element is wider than a contact: the displacement is a third too small"
        yield case("base", "scenes:warning", {}, law=law, words=words, reason=reason)
    words = "is stiffer than the mesh below it"
    reason = "what the mesh gives way under a contact is more than Hertz's compliance"
    heavy = {**COARSE, "load.axial": 1e5, "excitation": None}
    yield case("axial load 100 kN", "scenes:refusal", heavy, "resultants", base, words=words, reason=reason)
    yield case("friction 1.0, a force acts at once", "scenes:rubbing", {**_EXCITED, "contact.friction": 1.0})
    for name in transient(registry):
        yield case("a force acts at once", "scenes:sudden_force", _EXCITED, integrator=name)


def _messages(base: Tables) -> Iterator[Case]:
    """Scenes that are refused, or that users are warned about."""
    for measure, messages in (("refusal", _REFUSALS), ("warning", _WARNINGS)):
        for name, changes, words, reason in messages:
            arguments = {"tables": base, "changes": changes, "words": words, "reason": reason}
            yield Case(name, f"scenes:{measure}", {}, arguments)


def _elements() -> Iterator[Case]:
    for aspect in (1, 20, 200):
        yield Case("slender elements, explicit steps", "elements:slender_steps", {}, {"aspect": aspect}, aspect == 200)
        for poisson, young in ((0.29, 212e9), (0.4999, 1e7)):
            arguments = {"aspect": aspect, "poisson": poisson, "young": young}
            yield Case("slender elements, tension", "elements:slender_bar", {}, arguments, aspect == 200)
    yield Case("nearly incompressible cantilever", "elements:locking")
    yield Case("rubber on ceramic, elements", "elements:soft_on_hard")
    yield Case("elements without a volume", "elements:bad_elements")
