"""The catalogue of stiff and extreme cases: extreme scenes, penalties, surface points, elastic bodies, refusals and warnings.

What a case measures is in the module that its ``measure`` names.
"""

import json
from collections.abc import Iterator, Mapping
from importlib.resources import files

import attrs

from raceway import SceneError
from raceway.extend import Entry, ReadTables, Registry, Tables, line_contact

#: The scenes, their changes, and what each list of them is for (``about``).
_DATA: Tables = json.loads(files("raceway_checks").joinpath("data/stability.json").read_text(encoding="utf-8"))
BASE, TINY, COARSE, _POINTS = (_DATA[name] for name in ("base", "tiny", "coarse", "points"))
SCENES: list[tuple[str, Tables, bool, str]] = _DATA["scenes"]
#: Nothing that loses energy.
UNDAMPED = {"contact.damping": 0.0, "rotor.damping": 0.0, "contact.friction": 0.0}
STATIC: Tables = {"kinematics.ball_inertia": False}
_PENALTIES = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)
#: Step over the limit and amplitude over the approach of undamped steps: contacts stay closed, or open.
_UNDAMPED = ((0.1, 0.03), (0.02, 1.5))
_AT_REST = "scenes:condensed_at_rest"


@attrs.frozen
class Case:
    """One place of the catalogue; small enough to be sent to another process."""

    name: str  # what its rows are called by
    #: ``module:function``, a module of this folder or a whole path, called as ``function(rows, bench, **arguments)``
    measure: str
    setting: Mapping[str, object] = attrs.field(factory=dict)  # law, integrator, what else was varied
    #: plain values; ``tables`` and ``changes`` of a scene make the ``Bench``, which is None without
    arguments: Tables = attrs.field(factory=dict)
    quick: bool = True  # whether it belongs to what is run unless all is asked for


def _force(newton: float) -> Tables:
    """A rotating force that is the same at every speed."""
    return {"excitation.amplitude": "constant", "excitation.force": newton}


#: 15 000 r/min, a force that acts at once.
_EXCITED: Tables = {"excitation.kind": "bidirectional", "excitation.speed_rpm": 15000.0, **_force(60.0)}


def transient_integrators(registry: Registry) -> list[Entry]:
    """Integrators that march through time with inertia.  One that finds a steady orbit instead says ``steady = True``."""
    return [entry for entry in registry.of_kind("integrator") if entry.plugin.inertial and not entry.plugin.steady]


def transient(registry: Registry) -> list[str]:
    """Names of the integrators that march through time with inertia."""
    return [entry.name for entry in transient_integrators(registry)]


def laws_with(registry: Registry, *discretisations: str) -> list[str]:
    """Names of the laws of ball contacts that know these discretisations."""
    laws = [entry for entry in registry.of_kind("contact_law") if not line_contact(entry.plugin)]
    return [law.name for law in laws if set(discretisations) <= set(law.plugin.discretisations)]


def law_changes(name: str, registry: Registry) -> Tables:
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

    tables : plain tables of a user's scene; the base scene and the full catalogue when None

    SceneError: A scene whose contacts are surface points.
    """
    base = dict(tables) if tables is not None else BASE
    if base.get("contact", {}).get("discretisation") == "nodal":
        why = "the cases move bearings through a million steps, which takes forces of whole contacts: use 'resultant'"
        raise SceneError.at("contact.discretisation", "nodal", why)
    cases = _any_scene(base, registry, own=tables is not None)
    if tables is not None:
        return tuple(cases)
    messages = (
        Case(name, f"scenes:{measure}", {}, {"tables": base, "changes": changes, "words": words, "reason": reason})
        for measure, kind in (("refusal", "refusals"), ("warning", "warnings"))
        for name, changes, words, reason in _DATA[kind]
    )
    parts = (_contacts(base, registry), _scenes(base, registry), _points(base, registry), _elastic(base, registry))
    return (*cases, *(case for part in parts for case in part), *messages, *_elements())


def _any_scene(base: Tables, registry: Registry, own: bool) -> Iterator[Case]:
    """Steps around the limit, orbits, undamped steps, penalties; ``own``: of a user's scene, whose orbit is its own."""
    laws = laws_with(registry, "resultant")
    for name in transient(registry):
        by_name: Tables = {"tables": base, "integrator": name}
        yield Case("steps around the limit, linear", "motions:linear", {"integrator": name}, by_name)
        for law in laws:
            setting, changes = {"integrator": name, "law": law}, law_changes(law, registry)
            arguments = {**by_name, "changes": changes}
            for tilt in ("locked", "free"):
                with_tilt = {**arguments, "changes": {**changes, "supports.tilt": tilt}}
                title = "steps around the limit, small motions of the bearing"
                yield Case(title, "motions:small_motions", {**setting, "tilt": tilt}, with_tilt)
            orbit = "orbit at the safe limit", "motions:orbit_at_the_safe_limit"
            if own:
                yield Case(*orbit, setting, arguments)
            for axial, newton, tilt, quick in () if own else _DATA["orbits"]:
                orbiting = {**changes, "load.axial": axial, **_force(newton), "supports.tilt": tilt}
                setting_shown = {**setting, "axial": axial, "force": newton, "tilt": tilt}
                yield Case(*orbit, setting_shown, {**arguments, "changes": orbiting}, quick)
            for steps in (100_000,) if own else (100_000, 1_000_000):
                for factor, amplitude in _UNDAMPED:
                    without_damping = {**arguments, "steps": steps, "factor": factor, "amplitude": amplitude}
                    yield Case("undamped steps", "motions:many_steps", setting, without_damping, steps == 100_000)
    judge = "" if "excitation" not in base else "any" if own else "orbit"
    for factor in _PENALTIES if "penalty" in laws else ():
        arguments = {"tables": base, "changes": {"contact.kind": "penalty"}, "penalty_factor": factor, "judge": judge}
        setting_shown = {"law": "penalty", "penalty / default": factor}
        yield Case("penalty", "scenes:extreme", setting_shown, arguments, own or factor in (1e-3, 1e3))


def _contacts(base: Tables, registry: Registry) -> Iterator[Case]:
    """Impacts, deep penetrations, equilibria from afar, chatter."""
    names = transient(registry)
    for law in laws_with(registry, "resultant"):
        arguments: Tables = {"tables": base, "changes": law_changes(law, registry)}
        for name in names:
            common, setting = {**arguments, "integrator": name}, {"integrator": name, "law": law}
            for speed in (0.01, 1.0, 10.0):
                yield Case("impact", "motions:impact", setting, {**common, "speed": speed, "steps": 100})
            for depth in (1e-4, 5e-4):
                yield Case("deep initial penetration", "motions:deep_penetration", setting, {**common, "depth": depth})
        guesses = [1e-3, 5e-3, 5e-2, -1e-3, -5e-3]
        yield Case("equilibrium from afar", "motions:settled_from_afar", {"law": law}, {**arguments, "guesses": guesses})
        for name, options, step, chatters in _DATA["chatter"]:
            if name in names:
                falling = {**arguments, "integrator": name, "options": options, "step": step, "chatters": chatters}
                yield Case("chatter", "motions:chatter", {"integrator": name, "law": law}, falling)


def _scenes(base: Tables, registry: Registry) -> Iterator[Case]:
    for name, changes, exact, judge in SCENES:
        if exact:
            yield Case(f"Hertz' contacts: {name}", "scenes:hertz_factor", {}, {"tables": base, "changes": changes})
        for law in laws_with(registry, "resultant"):
            lawful = {**changes, **law_changes(law, registry)}
            arguments: Tables = {"tables": base, "judge": judge, "changes": lawful}
            yield Case(name, "scenes:extreme", {"law": law}, {**arguments, "closed_form": exact}, name in _DATA["quick"])
            if name in _DATA["condensed"]:
                arguments |= {"changes": {**lawful, "bodies.kind": "condensed"}, "may_be_too_stiff": True}
                yield Case(name, "scenes:extreme", {"law": law, "bodies": "condensed"}, arguments, False)


def _points(base: Tables, registry: Registry) -> Iterator[Case]:
    """Condensed bodies with every law that surface points can have."""
    turn: Tables = {"integrator.turns": 1, "integrator.steps_per_turn": 40}
    for law in laws_with(registry, "nodal"):

        def case(name: str, measure: str, changes: Tables, shown: Tables | None = None, law: str = law, **more: str) -> Case:
            setting = {"law": law, "bodies": "condensed, points", **(shown or {})}
            arguments = {"tables": base, "changes": {**_POINTS, **changes, "contact.kind": law}, **more}
            return Case(f"surface points: {name}", measure, setting, arguments, measure == _AT_REST and name == "base")

        for name, changes in _DATA["still"]:
            yield case(name, _AT_REST, changes)
        for name, changes, words, reason in _DATA["warned"]:
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

    for law in laws_with(registry, "nodal", "resultant"):
        for name, changes in _DATA["resultants"] if law == "hertz" else _DATA["resultants"][:1]:
            yield case(name, "scenes:calibrated_at_rest", {**changes, "excitation": None}, "resultants", base, law)
        for name, changes in _DATA["elastic_points"] if law == "hertz" else _DATA["elastic_points"][:1]:
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


def _elements() -> Iterator[Case]:
    for aspect in (1, 20, 200):
        yield Case("slender elements, explicit steps", "elements:slender_steps", {}, {"aspect": aspect}, aspect == 200)
        for poisson, young in ((0.29, 212e9), (0.4999, 1e7)):
            arguments = {"aspect": aspect, "poisson": poisson, "young": young}
            yield Case("slender elements, tension", "elements:slender_bar", {}, arguments, aspect == 200)
    yield Case("nearly incompressible cantilever", "elements:locking")
    yield Case("rubber on ceramic, elements", "elements:soft_on_hard")
    yield Case("elements without a volume", "elements:bad_elements")
