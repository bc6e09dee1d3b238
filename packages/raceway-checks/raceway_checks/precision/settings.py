"""Settings of a precision study: the axes that the user names, or a design made from the scene.

The default design is a union of small products, one for each question, not the product of all axes:

time step         every integrator with inertia x steps per turn, in halvings
steady orbit      integrators that solve for the orbit itself x their tolerance
few turns         the scene's integrator over three turns x few steps: what a rough answer costs
turns and start   the scene's integrator x how the motion starts x turns, at steps so fine that only the transient is left
mesh              element sizes about the scene's own, where bodies have a mesh
models            what changes the physics, one at a time: law, discretisation, bodies, identifier, no inertia
"""

import json
from collections.abc import Callable, Mapping
from itertools import product
from typing import NotRequired

import attrs

from raceway import RacewayError, Scene, SceneError, make_plan, scene_from_dict
from raceway.extend import (
    AXIAL_DISPLACEMENT, Integrator, Mesher, ReadTables, Registry, Store, Tables, Vary, Z_IMAG, Z_REAL,
    axes_of, points, refuse_mistakes, tables_at,
)  # fmt: skip
from raceway_checks.precision.timing import Measured, measured_once

STEPS = (45, 90, 180, 360, 720, 1440)
TURNS = (3, 6, 12, 24, 48)
_STARTS = ("orbit", "ramp", "static")
_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
#: Steps a turn of the transient's ladder.
_FINE_STEPS = 720
_FEW_STEPS, _FEW_TURNS = (24, 45, 90, 180), 3
#: Factors on the scene's element size.
_SIZES = (2.0, 1.414, 1.0, 0.707)
#: Tables whose keys choose how the equations are solved, not which.
_NUMERICAL = ("integrator", "mesh")
_REASON = 160


@attrs.frozen
class Setting:
    """One place of a study."""

    family: str  # the question it belongs to
    values: Tables  # key -> value, what it changes in the scene
    #: the part of ``values`` that changes the equations; ``inertia`` is among them, although an integrator sets it
    model: Tables
    tables: Tables  # the scene's tables with the changes
    scene: Scene | None  # None where it is refused, for ``reason``
    physics: str = ""  # the same for settings that differ in how they are solved only
    predicted_s: float = 0.0
    reason: str = ""


@attrs.frozen
class Design:
    """Settings to run; what was left out with its reason; the physics that other models are compared with."""

    settings: tuple[Setting, ...]
    left_out: tuple[tuple[str, Tables, str], ...]
    base: str
    title: str
    notes: tuple[str, ...] = ()


def make_design(tables: ReadTables, vary: Vary, limit_s: float, registry: Registry) -> Design:
    """The settings of a study.

    vary : axes whose product is run; the default design where there are none
    limit_s : settings whose predicted time is longer are left out

    SceneError: A mistake in the scene or in an axis.
    """
    axes_given, notes = vary if isinstance(vary, Mapping) else list(vary), list[str]()
    if axes_given:
        axes = axes_of(axes_given, tables, registry)
        title = refuse_mistakes(tables, axes, registry)
        candidates = [("axes", point) for point in points(axes)]
    else:
        scene = scene_from_dict(tables, registry)
        title, candidates = scene.title, _default_points(scene, registry)
    settings: list[Setting] = []
    left_out = []
    for family, values in candidates:
        setting = setting_at(tables, family, values, registry, notes)
        if setting.scene is not None and setting.predicted_s > limit_s:
            left_out.append((family, values, f"predicted {setting.predicted_s:.3g} s, above the limit of {limit_s:g} s"))
        elif setting.scene is None and not axes_given:
            left_out.append((family, values, setting.reason))
        elif all(setting.tables != previous.tables for previous in settings):
            settings.append(setting)
    if not settings:
        why = left_out[0][2] if left_out else "the scene is static and has no mesh"
        raise SceneError.at("--vary", None, f"no setting is left to run: {why}")
    # The scene's own physics where it is among the settings, else the first's.
    physics = setting_at(tables, "", {}, registry).physics
    runnable = [setting.physics for setting in settings if setting.scene is not None]
    base = physics if physics in runnable or not runnable else runnable[0]
    return Design(tuple(settings), tuple(left_out), base, title, tuple(notes))


def setting_at(
    tables: ReadTables, family: str, values: Tables, registry: Registry, notes: list[str] | None = None
) -> Setting:
    """One setting, checked and planned."""
    scene_tables = tables_at(tables, values, registry, notes)
    model = {key: value for key, value in values.items() if key.partition(".")[0] not in _NUMERICAL}
    try:
        scene = scene_from_dict(scene_tables, registry)
        plan = make_plan(scene)
    except RacewayError as error:
        reason = str(error).splitlines()[0]
        reason = reason if len(reason) <= _REASON else f"{reason[: _REASON - 3]}..."
        return Setting(family, values, model, scene_tables, None, reason=reason)
    if needs_motion(scene) and not scene.integrator.method.inertial:
        model["inertia"] = False
    inertial = not needs_motion(scene) or scene.integrator.method.inertial
    content = {name: part for name, part in scene.to_dict().items() if name not in (*_NUMERICAL, "title")}
    physics = json.dumps([content, inertial], sort_keys=True, default=str)
    return Setting(family, values, model, scene_tables, scene, physics, plan.predicted_work_s)


def needs_motion(scene: Scene) -> bool:
    """Whether an integrator takes part at all."""
    return scene.excitation is not None and "record" in scene.identifier.method.needs


def _default_points(scene: Scene, registry: Registry) -> list[tuple[str, Tables]]:
    """Family and values of every setting of the default design that has a meaning for the scene."""
    points: list[tuple[str, Tables]] = []
    if needs_motion(scene):
        methods: dict[str, type[Integrator]] = {entry.name: entry.plugin for entry in registry.of_kind("integrator")}
        steady = [name for name, method in methods.items() if method.steady]
        for name, steps in product((n for n, m in methods.items() if m.inertial and n not in steady), STEPS):
            points.append(("time step", {"integrator.kind": name, "integrator.steps_per_turn": steps}))
        for name, tolerance in product(steady, _TOLERANCES):
            options = {field.name for field in attrs.fields(methods[name])}
            kind: dict[str, object] = {"integrator.kind": name}
            points.append(("steady orbit", {**kind, "integrator.tolerance": tolerance} if "tolerance" in options else kind))
        integrator = scene.integrator.method
        if integrator.inertial and not integrator.steady:
            for steps in _FEW_STEPS:
                points.append(("few turns", {"integrator.turns": _FEW_TURNS, "integrator.steps_per_turn": steps}))
            for start, turns in product(_STARTS, TURNS):
                values = {"integrator.start": start, "integrator.turns": turns, "integrator.steps_per_turn": _FINE_STEPS}
                points.append(("turns and start", values))
        points += [("models", {"integrator.kind": n}) for n, m in methods.items() if not m.inertial]
    size = getattr(scene.mesh, "element_size", None)
    if size is not None:
        points += [("mesh", {"mesh.element_size": float(f"{size * factor:.3g}")}) for factor in _SIZES]
    points.append(("models", {"contact.kind": scene.contact.kind}))
    alternatives = {
        "contact.kind": [n for n in registry.names("contact_law") if n != scene.contact.kind],
        "contact.discretisation": [d for d in ("resultant", "nodal") if d != scene.contact.discretisation],
        "bodies.kind": [n for n in registry.names("bodies") if n != scene.bodies.name],
    }
    if scene.excitation is not None:
        alternatives["identifier.kind"] = [n for n in registry.names("identifier") if n != scene.identifier.kind]
    points += [("models", {key: value}) for key, values in alternatives.items() for value in values]
    return points


#: Steps of the reference over the finest steps of the rows, and its least steps and turns.
_FINER = 4
_LEAST_STEPS = 2880
_LEAST_TURNS = 24
#: Newmark's error has one sign, central differences' the other; the third where one of them cannot run.
_METHODS = ("newmark", "central_difference", "generalized_alpha")
_TIGHT = 1e-10
#: Smallest bound that is claimed [relative]: equilibria and steps are iterated to 1e-9 of the forces.
_FLOOR = 1e-10


class SettingRun(Measured):
    """A setting that was run, with the order that its errors should have; ``physics`` decides which ones are compared."""

    family: str
    setting: Tables
    model: Tables
    physics: str
    expected_order: int | None
    reused: bool


class Judged(SettingRun):
    """A row beside its reference; ``base`` and ``time_s`` as precision.json has them."""

    value: float | None
    error: float | None
    errors: dict[str, float]
    at_bound: bool
    order: float | None
    base: NotRequired[bool]
    time_s: NotRequired[float | None]


Values = dict[str, float]
_PARTS_OF_Z = (Z_REAL.name, Z_IMAG.name)


@attrs.frozen
class Reference:
    """Quantities, the bound of each in its own unit, and how they were found; empty where there is none."""

    values: Values
    bounds: Values
    how: str

    @property
    def size(self) -> float:
        """Size that relative errors of the main quantity refer to."""
        return main_size(self.values)

    def relative(self, difference: Values) -> Values:
        """Of differences from it: parts of Z over its size, other quantities over themselves."""
        sizes = {name: self.size if name in _PARTS_OF_Z else abs(self.values[name]) or 1.0 for name in difference}
        return {name: difference[name] / sizes[name] for name in difference}

    @property
    def bound(self) -> float:
        """Relative, of the main quantity."""
        return distance(self.bounds) / self.size if self.values else float("inf")


def main_size(values: Mapping[str, float]) -> float:
    """|Z|, or of a static scene the axial displacement."""
    return distance(values) or 1.0


def distance(values: Mapping[str, float]) -> float:
    """Length of the main quantity, or of a difference of it: Z as a complex number."""
    if Z_REAL.name in values:
        return abs(complex(*(values[name] for name in _PARTS_OF_Z)))
    return abs(values[AXIAL_DISPLACEMENT.name])


def minus(a: Mapping[str, float], b: Mapping[str, float]) -> Values:
    return {name: a[name] - b[name] for name in a if name in b}


@attrs.frozen(eq=False)
class Runner:
    """Runs reference settings, each once and stored like rows."""

    registry: Registry
    store: Store
    limit_s: float
    on_run: Callable[[str], None]

    def at(self, setting: Setting, values: ReadTables) -> Measured | None:
        """The measured run of a setting with some values changed; None where it is refused, fails or takes too long."""
        tables = tables_at(setting.tables, values, self.registry)
        reference = setting_at(tables, "reference", {}, self.registry)
        if reference.scene is None or reference.predicted_s > self.limit_s:
            return None
        self.on_run(f"reference: {', '.join(f'{k} = {v}' for k, v in values.items())}")
        row, _ = measured_once(reference.scene, 1, "reference", self.registry, self.store)
        return row if row["status"] == "completed" else None


def find_reference(group: list[Setting], runner: Runner, changes: ReadTables | None) -> Reference:
    """The reference of settings that share their physics."""
    sizes = sorted({float(size) for s in group if (size := getattr(_mesh(s), "element_size", None)) is not None})
    first = next((s for s in group if getattr(_mesh(s), "element_size", None) == (sizes[0] if sizes else None)), group[0])
    if changes:
        words = ", ".join(f"{key} = {value}" for key, value in changes.items())
        row = runner.at(first, changes)
        if row is None:
            return Reference({}, {}, f"the given reference ({words}) could not be run")
        error = row["own_error"]
        bound = float("inf") if error is None else error
        note = "which it has no estimate of" if error is None else "as it estimates itself"
        return Reference(row["quantities"], _all(row["quantities"], bound), f"given: {words}; its error {note}")
    reference = _of_one_mesh(first, group, runner)
    if len(sizes) < 2 or not reference.values:
        return reference
    finer = _of_one_mesh(first, group, runner, {"mesh.element_size": 0.5 * sizes[0]})
    if not finer.values:
        return attrs.evolve(
            reference, bounds=dict.fromkeys(reference.bounds, float("inf")), how=f"{reference.how}; no finer mesh could run"
        )
    change = minus(finer.values, reference.values)
    bounds = {name: finer.bounds[name] + abs(change[name]) for name in finer.values}
    how = f"{finer.how}; elements of {0.5 * sizes[0]:.3g} m, bound by the change from {sizes[0]:.3g} m"
    return Reference(finer.values, bounds, how)


def _mesh(setting: Setting) -> Mesher | None:
    return None if setting.scene is None else setting.scene.mesh


def _of_one_mesh(first: Setting, group: list[Setting], runner: Runner, extra: ReadTables | None = None) -> Reference:
    scene, extra = first.scene, dict(extra or {})
    assert scene is not None
    if not needs_motion(scene):
        row = runner.at(first, extra)
        if row is None:
            return Reference({}, {}, "the equilibrium could not be found")
        bound = max(row["own_error"] or 0.0, _FLOOR)
        return Reference(row["quantities"], _all(row["quantities"], bound), "nothing is integrated: solved to a residual")
    scenes = [s.scene for s in group if s.scene is not None]
    finest = [s.integrator.steps_per_turn for s in scenes if isinstance(s.integrator.steps_per_turn, int)]
    steps, turns = max(finest, default=360), max(s.integrator.turns for s in scenes)
    if not scene.integrator.method.inertial:
        rows = [runner.at(first, {**extra, "integrator.steps_per_turn": n * steps}) for n in (2, _FINER)]
        if rows[0] is None or rows[1] is None:
            return Reference({}, {}, "the series of equilibria at finer steps could not be run")
        values, change = rows[1]["quantities"], minus(rows[1]["quantities"], rows[0]["quantities"])
        floor = _all(values, max(_FLOOR, rows[1]["own_error"] or 0.0))
        bounds = {name: max(abs(change[name]), floor[name]) for name in values}
        how = f"series of {_FINER * steps} equilibria per turn; bound by its own estimate and its change from {2 * steps}"
        return Reference(values, bounds, how)
    # Where every turn is alike, a longer run shows the same; elsewhere the window belongs to the question.
    alike = scene.contact.friction == 0.0 and not scene.kinematics.orbiting and scene.excitation.period_s is not None
    common = {**extra, "integrator.turns": max(turns, _LEAST_TURNS) if alike else turns}
    if alike:
        common["integrator.start"] = "orbit"
    by_time = _transients(first, steps, common, runner)
    direct = _direct(first, extra, runner) if alike else None
    if direct is None:
        return by_time
    if not by_time.values:
        how = f"{direct.how}, bound by its own estimate; no transient could confirm it"
        return attrs.evolve(direct, how=how)
    apart = minus(direct.values, by_time.values)
    off = distance(apart) / direct.size
    if off <= direct.bound + by_time.bound:
        how = f"{direct.how}, bound by its own estimate; confirmed to {off:.1g} by {by_time.how}"
        return attrs.evolve(direct, how=how)
    bounds = {name: max(direct.bounds[name], abs(apart[name])) for name in direct.values}
    return Reference(direct.values, bounds, f"{direct.how}, bound by its distance from {by_time.how}")


def _all(values: Values, relative: float) -> Values:
    """The same relative bound for every quantity; parts of Z are measured by |Z|."""
    size = main_size(values)
    return {name: relative * (size if name in _PARTS_OF_Z else abs(value)) for name, value in values.items()}


def _direct(first: Setting, extra: Tables, runner: Runner) -> Reference | None:
    """The steady orbit solved for directly, by whatever integrator is made for that."""
    for name, method in ((entry.name, entry.plugin) for entry in runner.registry.of_kind("integrator")):
        if not method.steady:
            continue
        options = {field.name for field in attrs.fields(method)}
        tight = {"integrator.tolerance": _TIGHT} if "tolerance" in options else {}
        row = runner.at(first, {**extra, "integrator.kind": name, **tight})
        if row is not None and row["own_error"] is not None:
            how = f"steady orbit by '{name}'" + (f" to {_TIGHT:g}" if tight else "")
            return Reference(row["quantities"], _all(row["quantities"], max(row["own_error"], _FLOOR)), how)
    return None


def _transients(first: Setting, finest: int, common: Tables, runner: Runner) -> Reference:
    steps = max(_FINER * finest, _LEAST_STEPS)
    #: Method, values at step zero, the change to them, and what is left of the transient [relative].
    extrapolations: list[tuple[str, Values, Values, float]] = []
    while not extrapolations and steps > finest:
        for name in _METHODS:
            if len(extrapolations) == 2 or name not in runner.registry.names("integrator"):
                continue
            at = {**common, "integrator.kind": name}
            coarse, fine = (runner.at(first, {**at, "integrator.steps_per_turn": n}) for n in (steps // 2, steps))
            if coarse is None or fine is None:
                continue
            method: type[Integrator] = runner.registry.find("integrator", name).plugin
            gain = 1.0 / (2.0**method.order - 1.0)
            change = {key: gain * part for key, part in minus(fine["quantities"], coarse["quantities"]).items()}
            values = {key: fine["quantities"][key] + part for key, part in change.items()}
            extrapolations.append((name, values, change, fine["transient_error"] or 0.0))
        steps = steps if extrapolations else steps // 2
    if not extrapolations:
        return Reference({}, {}, "no transient at finer steps than the rows' could be run within the limit of time")
    name, values, change, remainder = extrapolations[0]
    floor = _all(values, max(_FLOOR, remainder))
    turns = common["integrator.turns"]
    if len(extrapolations) == 1:
        bounds = {key: abs(change[key]) + floor[key] for key in values}
        how = f"'{name}' at {steps} steps per turn, {turns} turns, extrapolated to step zero; bound by what that changes"
        return Reference(values, bounds, how)
    second_name, second, _, remainder = extrapolations[1]
    apart = minus(second, values)
    floor = _all(values, max(_FLOOR, remainder, extrapolations[0][3]))
    middle = {key: value + 0.5 * apart[key] for key, value in values.items()}
    bounds = {key: abs(apart[key]) + floor[key] for key in values}
    how = f"'{name}' and '{second_name}' at {steps} steps per turn, {turns} turns, extrapolated to step zero; bound by their distance"
    return Reference(middle, bounds, f"{how} and by what is left of the transient")
