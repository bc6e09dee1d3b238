"""The catalogue of stiff and extreme cases.  What a case measures is in the modules that it names, data in ``extremes``."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from raceway.errors import SceneError
from raceway.framework.registry import Registry
from raceway.storage.tables import ReadTables
from raceway.studies.stability import extremes as data
from raceway.studies.stability.case import Case
from raceway.studies.stability.extremes import Changes, force
from raceway.studies.stability.systems import BASE, laws_with, transient, with_law

#: Axial load, rotating force [N] and tilt of orbits from small to lift-off, and whether they are quick ones.
_ORBITS = (
    (400.0, 100.0, "locked", False), (400.0, 400.0, "locked", False), (400.0, 800.0, "locked", False),
    (400.0, 1500.0, "locked", True), (1000.0, 3000.0, "locked", False), (1000.0, 6000.0, "locked", False),
    (400.0, 400.0, "free", False), (400.0, 800.0, "free", False),
)  # fmt: skip
#: Step over the limit and amplitude over the approach of undamped steps: contacts stay closed, or open.
_UNDAMPED = ((0.1, 0.03), (0.02, 1.5))
#: integrator, options, step over the contact's period, whether it may chatter: the law decides.
_CHATTER: tuple[tuple[str, Changes, float, bool], ...] = (
    ("newmark", {}, 1.0, True),
    ("newmark", {}, 0.05, False),
    ("generalized_alpha", {"rho_infinity": 0.5}, 1.0, False),
    ("generalized_alpha", {"rho_infinity": 0.0}, 1.0, False),
    ("central_difference", {}, 0.05, False),
)


def catalogue(registry: Registry, tables: ReadTables | None = None) -> tuple[Case, ...]:
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
    cases = _any_scene(base, registry, own=tables is not None)
    if tables is not None:
        return tuple(cases)
    parts = (_contacts(base, registry), _scenes(base, registry), _points(base, registry), _elastic(base, registry))
    return (*cases, *(case for part in parts for case in part), *_told(base), *_elements())


def _any_scene(base: Changes, registry: Registry, own: bool) -> Iterator[Case]:
    """Steps around the limit, orbits, undamped steps, penalties; ``own``: of a user's scene, whose orbit is its own."""
    laws = laws_with(registry, "resultant")
    for name in transient(registry):
        yield Case(
            "steps around the limit, linear", "limits:linear", {"integrator": name}, {"tables": base, "integrator": name}
        )
        for law in laws:
            setting, with_it = {"integrator": name, "law": law}, with_law(law, registry)
            given = {"tables": base, "integrator": name, "changes": with_it}
            for tilt in ("locked", "free"):
                yield Case(
                    "steps around the limit, small motions of the bearing", "limits:small_motions", {**setting, "tilt": tilt},
                    {**given, "changes": {**with_it, "supports.tilt": tilt}},
                )  # fmt: skip
            orbit = "orbit at the safe limit", "limits:orbit_at_the_safe_limit"
            if own:
                yield Case(*orbit, setting, given)
            for axial, newton, tilt, quick in () if own else _ORBITS:
                changes = {**with_it, "load.axial": axial, **force(newton), "supports.tilt": tilt}
                shown = {**setting, "axial": axial, "force": newton, "tilt": tilt}
                yield Case(*orbit, shown, {**given, "changes": changes}, quick)
            for steps in (100_000,) if own else (100_000, 1_000_000):
                for factor, amplitude in _UNDAMPED:
                    more = {"steps": steps, "factor": factor, "amplitude": amplitude}
                    yield Case("undamped steps", "energy:many_steps", setting, {**given, **more}, steps == 100_000)
    for factor in data.PENALTIES if "penalty" in laws else ():
        arguments = {
            "tables": base, "changes": {"contact.kind": "penalty"}, "penalty_factor": factor,
            "judge": "" if "excitation" not in base else "any" if own else "orbit",
        }  # fmt: skip
        shown = {"law": "penalty", "penalty / default": factor}
        yield Case("penalty", "scenes:extreme", shown, arguments, own or factor in (1e-3, 1e3))


def _contacts(base: Changes, registry: Registry) -> Iterator[Case]:
    """Impacts, deep penetrations, equilibria from afar, chatter."""
    names = transient(registry)
    for law in laws_with(registry, "resultant"):
        given: Changes = {"tables": base, "changes": with_law(law, registry)}
        for name in names:
            moved, setting = {**given, "integrator": name}, {"integrator": name, "law": law}
            for speed in (0.01, 1.0, 10.0):
                yield Case("impact", "energy:impact", setting, {**moved, "speed": speed, "steps": 100})
            for depth in (1e-4, 5e-4):
                yield Case("deep initial penetration", "energy:deep_penetration", setting, {**moved, "depth": depth})
        guesses = [1e-3, 5e-3, 5e-2, -1e-3, -5e-3]
        yield Case("equilibrium from afar", "energy:settled_from_afar", {"law": law}, {**given, "guesses": guesses})
        for name, options, step, chatters in _CHATTER:
            if name in names:
                more = {"integrator": name, "options": options, "step": step, "chatters": chatters}
                yield Case("chatter", "energy:chatter", {"integrator": name, "law": law}, {**given, **more})


def _scenes(base: Changes, registry: Registry) -> Iterator[Case]:
    for name, changes, closed, judge in data.SCENES:
        quick = name in data.QUICK
        if closed:
            yield Case(f"Hertz' contacts: {name}", "scenes:hertz_factor", {}, {"tables": base, "changes": changes})
        for law in laws_with(registry, "resultant"):
            with_it = {**changes, **with_law(law, registry)}
            given: Changes = {"tables": base, "judge": judge}
            yield Case(name, "scenes:extreme", {"law": law}, {**given, "changes": with_it, "closed_form": closed}, quick)
            if name in data.CONDENSED:
                more = {"changes": {**with_it, "bodies.kind": "condensed"}, "may_be_too_stiff": True}
                yield Case(name, "scenes:extreme", {"law": law, "bodies": "condensed"}, {**given, **more}, False)


def _points(base: Changes, registry: Registry) -> Iterator[Case]:
    """Condensed bodies with every law that surface points can have."""
    for law in laws_with(registry, "nodal"):
        setting = {"law": law, "bodies": "condensed, points"}

        def case(
            name: str, measure: str, changes: Changes, setting: Changes = setting, law: str = law, quick: bool = False, **more: Any
        ) -> Case:  # fmt: skip
            given = {"tables": base, "changes": {**data.POINTS, **changes, "contact.kind": law}, **more}
            return Case(f"surface points: {name}", measure, setting, given, quick)

        for name, changes in data.STILL:
            yield case(name, "surface:condensed_at_rest", changes, quick=name == "base")
        for name, changes, words, reason in data.WARNED:
            yield case(name, "scenes:warning", {**changes, "excitation": None}, words=words, reason=reason)
        for name in transient(registry):
            shown = {**setting, "integrator": name}
            turn: Changes = {"integrator.turns": 1, "integrator.steps_per_turn": 40}
            if registry.find("integrator", name).plugin.implicit:
                yield case("a turn", "surface:turn", turn, shown, integrator=name)
            else:
                told: dict[str, Any] = {"words": "through too many steps", "reason": "a step takes a tenth of a second"}
                yield case("a turn", "scenes:refusal", {**turn, "integrator.kind": name}, shown, **told)


def _elastic(base: Changes, registry: Registry) -> Iterator[Case]:
    """Whole contacts and pressures at points, with every law that both can have."""

    def case(
        name: str, measure: str, changes: Changes, bodies: str = "points", tables: Changes = data.TINY, law: str = "", **more: Any
    ) -> Case:  # fmt: skip
        setting = ({"law": law} if law else {}) | {"bodies": f"elastic, {bodies}"}
        setting |= {"integrator": more["integrator"]} if "integrator" in more else {}
        changes = {**changes, "contact.kind": law} if law else changes
        return Case(f"elastic bodies: {name}", measure, setting, {"tables": tables, "changes": changes, **more}, False)

    for law in laws_with(registry, "nodal", "resultant"):
        for name, changes in data.RESULTANTS if law == "hertz" else data.RESULTANTS[:1]:
            still = {**changes, "excitation": None}
            yield case(name, "elastic:calibrated_at_rest", still, "resultants", base, law)
        for name, changes in data.ELASTIC_POINTS if law == "hertz" else data.ELASTIC_POINTS[:1]:
            yield case(name, "elastic:points_at_rest", changes, law=law)
        words, reason = (
            "the displacement depend on the mesh",
            "an element is wider than a contact: the displacement is a third too small",
        )
        yield case("base", "scenes:warning", {}, law=law, words=words, reason=reason)
    words, reason = (
        "is stiffer than the mesh below it",
        "what the mesh gives way under a contact is more than Hertz's compliance",
    )
    heavy = {**data.COARSE, "load.axial": 1e5, "excitation": None}
    yield case("axial load 100 kN", "scenes:refusal", heavy, "resultants", base, words=words, reason=reason)
    yield case("friction 1.0, a force acts at once", "elastic:rubbing", {**data.EXCITED, "contact.friction": 1.0})
    for name in transient(registry):
        yield case("a force acts at once", "elastic:motion", data.EXCITED, integrator=name)


def _told(base: Changes) -> Iterator[Case]:
    """Scenes that are refused, or that a user must be told something about."""
    for measure, told in (("refusal", data.REFUSALS), ("warning", data.WARNINGS)):
        for name, changes, words, reason in told:
            given = {"tables": base, "changes": changes, "words": words, "reason": reason}
            yield Case(name, f"scenes:{measure}", {}, given)


def _elements() -> Iterator[Case]:
    for aspect in (1, 20, 200):
        yield Case("slender elements, explicit steps", "elements:slender_steps", {}, {"aspect": aspect}, aspect == 200)
        for poisson, young in ((0.29, 212e9), (0.4999, 1e7)):
            given = {"aspect": aspect, "poisson": poisson, "young": young}
            yield Case("slender elements, tension", "elements:slender_bar", {}, given, aspect == 200)
    yield Case("nearly incompressible cantilever", "elements:locking")
    yield Case("rubber on ceramic, elements", "elements:soft_on_hard")
    yield Case("elements without a volume", "elements:bad_elements")
