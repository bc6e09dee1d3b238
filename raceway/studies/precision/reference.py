"""Reference of a precision study, with a bound of its own error.

In this order:

1. the setting that the user names, with its own error estimate;
2. the steady orbit solved for directly, confirmed by the extrapolation below;
3. two transient methods whose errors have opposite signs, each at four times the finest steps of the rows and at half of
   that, extrapolated to step zero; their distance is the bound;
4. where nothing is integrated the run itself: its equilibrium is solved to a residual.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import attrs

from raceway.framework.registry import Registry
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.measured_run import measured_once
from raceway.studies.many.points import tables_at
from raceway.studies.many.row_store import RowStore
from raceway.studies.precision.design import Setting, is_steady, needs_motion, setting_at

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator, Mesher

#: Steps of the reference over the finest steps of the rows, and its least steps and turns.
FINER = 4
_LEAST_STEPS = 2880
_LEAST_TURNS = 24
#: Newmark's error has one sign, central differences' the other; the third where one of them cannot run.
METHODS = ("newmark", "central_difference", "generalized_alpha")
TIGHT = 1e-10
#: Smallest bound that is claimed [relative]: equilibria and steps are iterated to 1e-9 of the forces.
FLOOR = 1e-10

Values = dict[str, float]


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

    @property
    def bound(self) -> float:
        """Relative, of the main quantity."""
        return distance(self.bounds) / self.size if self.values else float("inf")


def main_size(values: Mapping[str, float]) -> float:
    """|Z|, or of a static scene the axial displacement."""
    return distance(values) or 1.0


def distance(values: Mapping[str, float]) -> float:
    """Length of the main quantity, or of a difference of it: Z as a complex number."""
    if "z_real" in values:
        return abs(complex(values["z_real"], values["z_imag"]))
    return abs(values["axial_displacement"])


def minus(a: Mapping[str, float], b: Mapping[str, float]) -> Values:
    return {name: a[name] - b[name] for name in a if name in b}


@attrs.frozen(eq=False)
class Runner:
    """Runs reference settings, each once and kept like rows."""

    registry: Registry
    store: RowStore
    limit_s: float
    on_run: Callable[[str], None]

    def at(self, setting: Setting, values: ReadTables) -> Tables | None:
        """The measured run of a setting with some values changed; None where it is refused, fails or takes too long."""
        tables = tables_at(setting.tables, values, self.registry)
        found = setting_at(tables, "reference", {}, self.registry)
        if found.scene is None or found.predicted_s > self.limit_s:
            return None
        self.on_run(f"reference: {', '.join(f'{k} = {v}' for k, v in values.items())}")
        row, _ = measured_once(found.scene, 1, "reference", self.registry, self.store)
        return row if row["status"] == "completed" else None


def find_reference(group: list[Setting], runner: Runner, given: ReadTables | None) -> Reference:
    """The reference of settings that share their physics."""
    sizes = sorted({float(size) for s in group if (size := getattr(_mesh(s), "element_size", None)) is not None})
    first = next((s for s in group if getattr(_mesh(s), "element_size", None) == (sizes[0] if sizes else None)), group[0])
    if given:
        return _given(first, given, runner)
    found = _of_one_mesh(first, group, runner)
    if len(sizes) < 2 or not found.values:
        return found
    finer = _of_one_mesh(first, group, runner, {"mesh.element_size": 0.5 * sizes[0]})
    if not finer.values:
        return attrs.evolve(
            found, bounds=dict.fromkeys(found.bounds, float("inf")), how=f"{found.how}; no finer mesh could run"
        )
    change = minus(finer.values, found.values)
    bounds = {name: finer.bounds[name] + abs(change[name]) for name in finer.values}
    how = f"{finer.how}; elements of {0.5 * sizes[0]:.3g} m, bound by the change from {sizes[0]:.3g} m"
    return Reference(finer.values, bounds, how)


def _mesh(setting: Setting) -> Mesher | None:
    return None if setting.scene is None else setting.scene.mesh


def _given(first: Setting, given: ReadTables, runner: Runner) -> Reference:
    words = ", ".join(f"{key} = {value}" for key, value in given.items())
    row = runner.at(first, given)
    if row is None:
        return Reference({}, {}, f"the given reference ({words}) could not be run")
    error = row["own_error"]
    bound = float("inf") if error is None else error
    note = "which it has no estimate of" if error is None else "as it estimates itself"
    return Reference(row["quantities"], _all(row["quantities"], bound), f"given: {words}; its error {note}")


def _of_one_mesh(first: Setting, group: list[Setting], runner: Runner, extra: ReadTables | None = None) -> Reference:
    scene, extra = first.scene, dict(extra or {})
    assert scene is not None
    if not needs_motion(scene):
        row = runner.at(first, extra)
        if row is None:
            return Reference({}, {}, "the equilibrium could not be found")
        bound = max(row["own_error"] or 0.0, FLOOR)
        return Reference(row["quantities"], _all(row["quantities"], bound), "nothing is integrated: solved to a residual")
    steps, turns = _finest(group)
    if not scene.integrator.method.inertial:
        return _equilibria(first, steps, runner, extra)
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


def _finest(group: list[Setting]) -> tuple[int, int]:
    """Most steps a turn and most turns of the rows."""
    scenes = [s.scene for s in group if s.scene is not None]
    steps = [s.integrator.steps_per_turn for s in scenes if isinstance(s.integrator.steps_per_turn, int)]
    return max(steps, default=360), max(s.integrator.turns for s in scenes)


def _all(values: Values, relative: float) -> Values:
    """The same relative bound for every quantity; parts of Z are measured by |Z|."""
    size = main_size(values)
    return {name: relative * (size if name in ("z_real", "z_imag") else abs(value)) for name, value in values.items()}


def _equilibria(first: Setting, steps: int, runner: Runner, extra: Tables) -> Reference:
    rows = [runner.at(first, {**extra, "integrator.steps_per_turn": n * steps}) for n in (2, FINER)]
    if rows[0] is None or rows[1] is None:
        return Reference({}, {}, "the series of equilibria at finer steps could not be run")
    values, change = rows[1]["quantities"], minus(rows[1]["quantities"], rows[0]["quantities"])
    floor = _all(values, max(FLOOR, rows[1]["own_error"] or 0.0))
    bounds = {name: max(abs(change[name]), floor[name]) for name in values}
    how = f"series of {FINER * steps} equilibria a turn; bound by its own estimate and its change from {2 * steps}"
    return Reference(values, bounds, how)


def _direct(first: Setting, extra: Tables, runner: Runner) -> Reference | None:
    """The steady orbit solved for directly, by whatever integrator is made for that."""
    registry = runner.registry
    for name in registry.names("integrator"):
        method = registry.find("integrator", name).plugin
        if not is_steady(method):
            continue
        known = {field.name for field in attrs.fields(method)}
        tight = {"integrator.tolerance": TIGHT} if "tolerance" in known else {}
        row = runner.at(first, {**extra, "integrator.kind": name, **tight})
        if row is not None and row["own_error"] is not None:
            how = f"steady orbit by '{name}'" + (f" to {TIGHT:g}" if tight else "")
            return Reference(row["quantities"], _all(row["quantities"], max(row["own_error"], FLOOR)), how)
    return None


def _transients(first: Setting, finest: int, common: Tables, runner: Runner) -> Reference:
    steps = max(FINER * finest, _LEAST_STEPS)
    found: list[tuple[str, Values, Values, float]] = []
    while not found and steps > finest:
        for name in METHODS:
            if len(found) < 2 and name in runner.registry.names("integrator"):
                one = _extrapolated(first, name, steps, common, runner)
                found += [] if one is None else [one]
        steps = steps if found else steps // 2
    if not found:
        return Reference({}, {}, "no transient at finer steps than the rows' could be run within the limit of time")
    name, values, change, rest = found[0]
    floor = _all(values, max(FLOOR, rest))
    turns = common["integrator.turns"]
    if len(found) == 1:
        bounds = {key: abs(change[key]) + floor[key] for key in values}
        how = f"'{name}' at {steps} steps a turn, {turns} turns, extrapolated to step zero; bound by what that changes"
        return Reference(values, bounds, how)
    other, second, _, rest = found[1]
    apart = minus(second, values)
    floor = _all(values, max(FLOOR, rest, found[0][3]))
    middle = {key: value + 0.5 * apart[key] for key, value in values.items()}
    bounds = {key: abs(apart[key]) + floor[key] for key in values}
    how = (
        f"'{name}' and '{other}' at {steps} steps a turn, {turns} turns, extrapolated to step zero; bound by their distance"
    )
    return Reference(middle, bounds, f"{how} and by what is left of the transient")


def _extrapolated(
    first: Setting, name: str, steps: int, common: Tables, runner: Runner
) -> tuple[str, Values, Values, float] | None:
    """Method, values at step zero, the change to them, and what is left of the transient [relative]."""
    at = {**common, "integrator.kind": name}
    coarse, fine = (runner.at(first, {**at, "integrator.steps_per_turn": n}) for n in (steps // 2, steps))
    if coarse is None or fine is None:
        return None
    method: type[Integrator] = runner.registry.find("integrator", name).plugin
    gain = 1.0 / (2.0**method.order - 1.0)
    change = {key: gain * part for key, part in minus(fine["quantities"], coarse["quantities"]).items()}
    values = {key: fine["quantities"][key] + part for key, part in change.items()}
    return name, values, change, fine["transient_error"] or 0.0
