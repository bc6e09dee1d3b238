"""The catalogue of stiff and extreme cases.  What a case measures is in the modules that it names, data in ``extremes``."""

from __future__ import annotations

from collections.abc import Iterator

from raceway.errors import SceneError
from raceway.framework.registry import Registry
from raceway.storage.tables import ReadTables
from raceway.studies.stability.case import Case
from raceway.studies.stability.elastic import elastic_cases
from raceway.studies.stability.extremes import CONDENSED, PENALTIES, REFUSALS, SCENES, WARNINGS, Changes, force
from raceway.studies.stability.surface import surface_cases
from raceway.studies.stability.systems import BASE, pair_laws, transient, with_law


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
    cases = [*_limits(base, registry), *_orbits(base, registry, tables is None), *_energy(base, registry, tables is None)]
    cases += _penalties(base, registry, "orbit" if tables is None else "any")
    if tables is None:
        cases += [
            *_scenes(base, registry),
            *surface_cases(base, registry),
            *elastic_cases(base, registry),
            *_refusals(base),
            *_elements(),
        ]
    return tuple(cases)


def _limits(base: Changes, registry: Registry) -> Iterator[Case]:
    for name in transient(registry):
        yield Case("steps around the limit, linear", "limits:linear", {"tables": base, "integrator": name}, 0.5)
        for law in pair_laws(registry):
            for tilt in ("locked", "free"):
                arguments = {
                    "tables": base, "integrator": name, "changes": {**with_law(law, registry), "supports.tilt": tilt},
                    "shown": {"law": law, "tilt": tilt},
                }  # fmt: skip
                yield Case("steps around the limit, small motions of the bearing", "limits:small_motions", arguments, 0.5)


def _orbits(base: Changes, registry: Registry, whole: bool) -> Iterator[Case]:
    """Orbits from small to lift-off; a user's scene has its own."""
    places = [
        (axial, newton, tilt)
        for axial, newton, tilt in (
            (400.0, 100.0, "locked"), (400.0, 400.0, "locked"), (400.0, 800.0, "locked"), (400.0, 1500.0, "locked"),
            (1000.0, 3000.0, "locked"), (1000.0, 6000.0, "locked"), (400.0, 400.0, "free"), (400.0, 800.0, "free"),
        )
    ]  # fmt: skip
    for name in transient(registry):
        for law in pair_laws(registry):
            for axial, newton, tilt in places if whole else [(None, None, None)]:
                changes: Changes = with_law(law, registry)
                shown: Changes = {"law": law}
                if axial is not None and newton is not None:
                    changes |= {"load.axial": axial, **force(newton), "supports.tilt": tilt}
                    shown |= {"axial": axial, "force": newton, "tilt": tilt}
                arguments = {"tables": base, "integrator": name, "changes": changes, "shown": shown}
                yield Case("orbit at the safe limit", "limits:orbit_at_the_safe_limit", arguments, 0.3)


def _energy(base: Changes, registry: Registry, whole: bool) -> Iterator[Case]:
    steps = 1_000_000 if whole else 100_000
    for law in pair_laws(registry):
        common: Changes = {"tables": base, "changes": with_law(law, registry), "shown": {"law": law}}
        for name in transient(registry):
            one = {**common, "integrator": name}
            for factor, amplitude in ((0.1, 0.03), (0.02, 1.5)):
                arguments = {**one, "steps": steps, "factor": factor, "amplitude": amplitude}
                yield Case("undamped steps", "energy:million_steps", arguments, 6e-6 * steps)
            if not whole:
                continue
            for speed in (0.01, 1.0, 10.0):
                yield Case("impact", "energy:impact", {**one, "speed": speed, "steps": 100}, 0.2)
            for depth in (1e-4, 5e-4):
                yield Case("deep initial penetration", "energy:deep_penetration", {**one, "depth": depth}, 0.3)
        if whole:
            far = {**common, "guesses": [1e-3, 5e-3, 5e-2, -1e-3, -5e-3]}
            yield Case("equilibrium from afar", "energy:settled_from_afar", far, 0.2)
            for name, options, step, chatters in _CHATTER:
                if name in transient(registry):
                    rest = {**common, "integrator": name, "options": options, "step": step, "chatters": chatters}
                    yield Case("chatter", "energy:chatter", rest, 0.1)


#: integrator, options, step over the contact's period, whether it may chatter: the law decides.
_CHATTER: tuple[tuple[str, Changes, float, bool], ...] = (
    ("newmark", {}, 1.0, True),
    ("newmark", {}, 0.05, False),
    ("generalized_alpha", {"rho_infinity": 0.5}, 1.0, False),
    ("generalized_alpha", {"rho_infinity": 0.0}, 1.0, False),
    ("central_difference", {}, 0.05, False),
)


def _penalties(base: Changes, registry: Registry, judge: str) -> Iterator[Case]:
    if "penalty" not in pair_laws(registry):
        return
    for factor in PENALTIES:
        arguments = {
            "tables": base, "changes": {"contact.kind": "penalty"}, "shown": {"law": "penalty", "penalty / default": factor},
            "penalty_factor": factor, "judge": judge if "excitation" in base else "",
        }  # fmt: skip
        yield Case("penalty", "scenes:extreme", arguments, 1.0)


def _scenes(base: Changes, registry: Registry) -> Iterator[Case]:
    for name, changes, closed, judge in SCENES:
        if closed:
            yield Case(f"Hertz' contacts: {name}", "scenes:hertz_factor", {"tables": base, "changes": changes}, 0.1)
        for law in pair_laws(registry):
            arguments: Changes = {
                "tables": base, "changes": {**changes, **with_law(law, registry)}, "shown": {"law": law}, "closed_form": closed,
                "judge": judge,
            }  # fmt: skip
            yield Case(name, "scenes:extreme", arguments, 1.5)
            if name in CONDENSED:
                elastic: Changes = {
                    **arguments, "changes": {**arguments["changes"], "bodies.kind": "condensed"}, "closed_form": False, "may_be_too_stiff": True,
                    "shown": {"law": law, "bodies": "condensed"},
                }  # fmt: skip
                yield Case(name, "scenes:extreme", elastic, 8.0)


def _refusals(base: Changes) -> Iterator[Case]:
    for name, changes, words, reason in REFUSALS:
        arguments = {"tables": base, "changes": changes, "words": words, "reason": reason, "shown": {}}
        yield Case(name, "scenes:refusal", arguments, 0.2)
    for name, changes, words, reason in WARNINGS:
        arguments = {"tables": base, "changes": changes, "words": words, "reason": reason, "shown": {}}
        yield Case(name, "scenes:warning", arguments, 0.2)


def _elements() -> Iterator[Case]:
    for aspect in (1, 20, 200):
        yield Case("slender elements, explicit steps", "elements:slender_steps", {"aspect": aspect}, 2.0)
        for poisson, young in ((0.29, 212e9), (0.4999, 1e7)):
            arguments = {"aspect": aspect, "poisson": poisson, "young": young}
            yield Case("slender elements, tension", "elements:slender_bar", arguments, 1.0)
    yield Case("nearly incompressible cantilever", "elements:locking", {}, 2.0)
    yield Case("rubber on ceramic, elements", "elements:soft_on_hard", {}, 1.0)
    yield Case("elements without a volume", "elements:bad_elements", {}, 0.5)
