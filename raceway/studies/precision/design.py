"""Settings of a precision study: the axes that the user names, or a design made from the scene.

The default design is a union of small products, one for each question, not the product of all axes:

time step         every integrator with inertia x steps a turn, in halvings
steady orbit      integrators that solve for the orbit itself x their tolerance
few turns         the scene's integrator over three turns x few steps: what a rough answer costs
turns and start   the scene's integrator x how the motion starts x turns, at steps so fine that only the transient is left
mesh              element sizes about the scene's own, where bodies have a mesh
models            what changes the physics, one at a time: law, discretisation, bodies, identifier, no inertia
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.framework.contracts import Integrator
from raceway.framework.registry import Registry
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.axes import points
from raceway.studies.many.points import axes_of, refuse_mistakes, tables_at

STEPS = (45, 90, 180, 360, 720, 1440)
TURNS = (3, 6, 12, 24, 48)
STARTS = ("orbit", "ramp", "static")
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
#: Steps a turn of the transient's ladder.
FINE_STEPS = 720
FEW_STEPS, FEW_TURNS = (24, 45, 90, 180), 3
#: Factors on the scene's element size.
SIZES = (2.0, 1.414, 1.0, 0.707)
BODIES = ("rigid", "condensed", "elastic")
#: Tables whose keys choose how the equations are solved, not which.
NUMERICAL = ("integrator", "mesh")
_REASON = 160


@attrs.frozen
class Setting:
    """One place of a study.

    Attributes
    ----------
    family : the question it belongs to
    values : key -> value, what it changes in the scene
    model : the part of ``values`` that changes the equations; ``inertia`` is among them, although an integrator sets it
    tables : the scene's tables with the changes
    scene : None where it is refused, for ``reason``
    physics : the same for settings that differ in how they are solved only
    """

    family: str
    values: Tables
    model: Tables
    tables: Tables
    scene: Scene | None
    physics: str = ""
    predicted_s: float = 0.0
    reason: str = ""


@attrs.frozen
class Design:
    """Settings to run; what was left out with its reason; the physics that other models are held against."""

    settings: tuple[Setting, ...]
    left_out: tuple[tuple[str, Tables, str], ...]
    base: str
    title: str
    notes: tuple[str, ...] = ()


def is_numerical(key: str) -> bool:
    """Whether a key changes how a model is solved (True) or the model itself."""
    return key.partition(".")[0] in NUMERICAL


def make_design(tables: ReadTables, vary: Iterable[str] | Mapping[str, Any], limit_s: float, registry: Registry) -> Design:
    """The settings of a study.

    Parameters
    ----------
    vary : axes whose product is run; the default design where there are none
    limit_s : settings whose predicted time is longer are left out

    Raises
    ------
    SceneError
        A mistake in the scene or in an axis.
    """
    given, notes = vary if isinstance(vary, Mapping) else list(vary), list[str]()
    if given:
        axes = axes_of(given, tables, registry)
        title = refuse_mistakes(tables, axes, registry)
        wanted = [("axes", point) for point in points(axes)]
    else:
        scene = scene_from_dict(tables, registry)
        title, wanted = scene.title, default_points(scene, registry)
    settings: list[Setting] = []
    left_out = []
    for family, values in wanted:
        setting = setting_at(tables, family, values, registry, notes)
        if setting.scene is not None and setting.predicted_s > limit_s:
            left_out.append((family, values, f"predicted {setting.predicted_s:.3g} s, above the limit of {limit_s:g} s"))
        elif setting.scene is None and not given:
            left_out.append((family, values, setting.reason))
        elif all(setting.tables != other.tables for other in settings):
            settings.append(setting)
    if not settings:
        why = left_out[0][2] if left_out else "the scene is static and has no mesh"
        raise SceneError.at("--vary", None, f"no setting is left to run: {why}")
    return Design(tuple(settings), tuple(left_out), _base(tables, settings, registry), title, tuple(notes))


def setting_at(
    tables: ReadTables, family: str, values: Tables, registry: Registry, notes: list[str] | None = None
) -> Setting:
    """One setting, checked and planned."""
    changed = tables_at(tables, values, registry, notes)
    model = {key: value for key, value in values.items() if not is_numerical(key)}
    try:
        scene = scene_from_dict(changed, registry)
        plan = make_plan(scene)
    except RacewayError as error:
        return Setting(family, values, model, changed, None, reason=short(str(error)))
    if needs_motion(scene) and not scene.integrator.method.inertial:
        model["inertia"] = False
    return Setting(family, values, model, changed, scene, _physics(scene), plan.predicted_work_s)


def needs_motion(scene: Scene) -> bool:
    """Whether an integrator takes part at all."""
    return scene.excitation is not None and "record" in scene.identifier.method.needs


def _base(tables: ReadTables, settings: list[Setting], registry: Registry) -> str:
    """The scene's own physics where it is among the settings, else the first's."""
    own = setting_at(tables, "", {}, registry).physics
    found = [setting.physics for setting in settings if setting.scene is not None]
    return own if own in found or not found else found[0]


def _physics(scene: Scene) -> str:
    inertial = not needs_motion(scene) or scene.integrator.method.inertial
    content = {name: part for name, part in scene.to_dict().items() if name not in (*NUMERICAL, "title")}
    return json.dumps([content, inertial], sort_keys=True, default=str)


def default_points(scene: Scene, registry: Registry) -> list[tuple[str, Tables]]:
    """Family and values of every setting of the default design that has a meaning for the scene."""
    found: list[tuple[str, Tables]] = []
    if needs_motion(scene):
        methods: Tables = {name: registry.find("integrator", name).plugin for name in registry.names("integrator")}
        steady = [name for name, method in methods.items() if is_steady(method)]
        for name, steps in product((n for n, m in methods.items() if m.inertial and n not in steady), STEPS):
            found.append(("time step", {"integrator.kind": name, "integrator.steps_per_turn": steps}))
        for name, tolerance in product(steady, TOLERANCES):
            known = {field.name for field in attrs.fields(methods[name])}
            one: Tables = {"integrator.kind": name}
            found.append(("steady orbit", {**one, "integrator.tolerance": tolerance} if "tolerance" in known else one))
        own = scene.integrator.method
        if own.inertial and not is_steady(type(own)):
            for steps in FEW_STEPS:
                found.append(("few turns", {"integrator.turns": FEW_TURNS, "integrator.steps_per_turn": steps}))
            for start, turns in product(STARTS, TURNS):
                values = {"integrator.start": start, "integrator.turns": turns, "integrator.steps_per_turn": FINE_STEPS}
                found.append(("turns and start", values))
        found += [("models", {"integrator.kind": n}) for n, m in methods.items() if not m.inertial]
    size = getattr(scene.mesh, "element_size", None)
    if size is not None:
        found += [("mesh", {"mesh.element_size": float(f"{size * factor:.3g}")}) for factor in SIZES]
    found.append(("models", {"contact.kind": scene.contact.kind}))
    others = {
        "contact.kind": [n for n in registry.names("contact_law") if n != scene.contact.kind],
        "contact.discretisation": [d for d in ("resultant", "nodal") if d != scene.contact.discretisation],
        "bodies.kind": [n for n in registry.names("bodies") if n != scene.bodies.name],
    }
    if scene.excitation is not None:
        others["identifier.kind"] = [n for n in registry.names("identifier") if n != scene.identifier.kind]
    found += [("models", {key: value}) for key, values in others.items() for value in values]
    return found


def is_steady(method: type[Integrator]) -> bool:
    """Whether an integrator solves for the periodic motion itself."""
    return method.steady


def short(text: str) -> str:
    """The first line of a reason, cut where it would fill a table."""
    line = text.splitlines()[0]
    return line if len(line) <= _REASON else f"{line[: _REASON - 3]}..."
