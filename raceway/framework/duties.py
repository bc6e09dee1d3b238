"""Duties of plug-ins as the program calls them: faults are put to the plug-in's name, duties that it leaves out have their defaults here."""

from collections.abc import Callable, Mapping
from functools import cached_property, partial
from typing import Any, TypeVar

import attrs
import numpy as np

from raceway.core.columns import at_rows, distinct, has_columns, length
from raceway.errors import Mistake, PluginError
from raceway.framework.contracts import (
    ContactLaw,
    ContactPairs,
    Cost,
    Excitation,
    LawReport,
    Problem,
    Quantities,
    SolvedPoints,
    Traits,
    said,
)
from raceway.framework.loading.sources import blamed
from raceway.framework.shown import Fact
from raceway.storage.tables import ReadTables, Tables

T = TypeVar("T")


def _answer(plugin: str, duty: str, call: Callable[[], T], *types: type) -> T:
    """What a duty returns; ``PluginError`` where it raises anything but a ``RacewayError``, or returns another type."""
    with blamed(plugin, f"{duty}()"):
        answer = call()
    if not isinstance(answer, types):
        words = " or ".join("None" if kind is type(None) else kind.__name__ for kind in types)
        raise PluginError(f"{plugin}: {duty}() returned {type(answer).__name__}; it must be {words}")
    return answer


class BodyKind:
    """The kind of bodies of a problem: its duties, which raise ``PluginError`` where the kind breaks them."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._plugin, self._name = problem, problem.bodies, f"bodies '{problem.bodies.name}'"

    def faults(self) -> list[Mistake]:
        return _answer(self._name, "faults", lambda: self._plugin.faults(self._problem), list)

    @cached_property
    def traits(self) -> Traits:
        return _answer(self._name, "traits", lambda: self._plugin.traits(self._problem), Traits)

    def stable_step(self) -> float | None:
        return _answer(self._name, "stable_step", lambda: self._plugin.stable_step(self._problem), float, type(None))

    def decide(self, parts: Any) -> None:
        _answer(self._name, "decide", lambda: self._plugin.decide(self._problem, parts), type(None))

    def cost(self, balls: Any, motion: Any, parts: Any) -> Cost:
        return _answer(self._name, "cost", lambda: self._plugin.cost(self._problem, balls, motion, parts), Cost)

    def build(self, plan: Any) -> Any:
        return _answer(self._name, "build", lambda: self._plugin.build(self._problem, plan), object)

    def columns(self, plan: Any) -> Any:
        return _answer(self._name, "columns", lambda: self._plugin.columns(self._problem, plan), object)

    def why_no_columns(self, key: str | None = None) -> str:
        """Why these bodies are not built at many points at once, or a continuous key can be no column; empty where it is so."""
        if not gives_columns(self._plugin):
            return "bodies are in full"
        why = said(self._plugin, "why_no_columns")
        return "" if why is None else _answer(self._name, "why_no_columns", lambda: why(self._problem, key), str)

    def same_bodies(self, changed: Problem) -> bool:
        """Whether another problem of this kind has the same meshes; where the kind does not say, unless there is a [mesh]."""
        same = said(self._plugin, "same_bodies")
        if same is None:
            return self._problem.mesh is None or self._problem.bearing == changed.bearing
        return bool(_answer(self._name, "same_bodies", lambda: same(self._problem, changed), object))


def unused_with_bodies(tables: Any) -> list[tuple[str, str]]:
    """(key, reason) for each key of a scene that changes nothing with its kind of bodies, or ``PluginError``; none unless it says so."""
    unused = said(tables.bodies, "unused")
    return [] if unused is None else _answer(f"bodies '{tables.bodies.name}'", "unused", lambda: unused(tables), list)


def fitting_quantities(problem: Problem) -> list[Quantities]:
    """Plug-ins of quantities whose numbers a problem has, by the order of their names; ``PluginError`` where one breaks its duty."""
    missing = missing_quantities(problem)
    return [getattr(problem.quantities, name) for name, why in missing.items() if not why]


def missing_quantities(problem: Problem) -> dict[str, str]:
    """Plug-in -> ``why_no_quantities``, by the order of their names."""
    table = problem.quantities
    names = [field.name for field in attrs.fields(type(table))]
    return {name: why_no_quantities(getattr(table, name), problem) for name in names}


def why_no_quantities(plugin: Quantities, problem: Problem) -> str:
    """What a problem lacks for the numbers of a plug-in, or ``PluginError``; empty where it has all."""
    return _answer(f"quantity '{plugin.name}'", "why_not", lambda: plugin.why_not(problem), str)


def quantity_screen(plugin: type[Quantities], result: ReadTables) -> list[Fact]:
    """Of a result the rows of a screen: the plug-in's own, or a heading and its numbers."""
    rows = said(plugin, "rows")
    if rows is not None:
        return _answer(f"quantity '{plugin.name}'", "rows", lambda: rows(result[plugin.name]), list)
    heading = (plugin.__doc__ or plugin.name).partition("\n")[0].rstrip(".")
    return [(heading, "", ""), *(number.fact(result) for number in plugin.numbers if not number.dims)]


def turn_samples(plugin: Quantities, problem: Problem) -> int:
    """Times of a turn at which a plug-in of quantities asks for contact forces, or ``PluginError``; 0 unless it says more."""
    samples = said(plugin, "turn_samples")
    return 0 if samples is None else _answer(f"quantity '{plugin.name}'", "turn_samples", lambda: samples(problem), int)


def quantities_at(plugin: Quantities, points: SolvedPoints) -> dict[str, np.ndarray]:
    """Numbers (n, ...) of a plug-in by their names, or ``PluginError``."""
    title, n = f"quantity '{plugin.name}'", len(points.load)
    answer = _answer(title, "compute", lambda: plugin.compute(points), Mapping)
    values = _answer(title, "compute", lambda: {k: np.ascontiguousarray(v, dtype=float) for k, v in answer.items()}, dict)
    names = [number.name for number in plugin.numbers]
    if missing := [name for name in names if name not in values] or [name for name in values if name not in names]:
        raise PluginError(f"{title}: compute() must return exactly its `numbers`: {', '.join(names)}; see '{missing[0]}'")
    for number in plugin.numbers:
        shape = values[number.name].shape
        if shape[:1] != (n,) or len(shape) != 1 + len(number.dims):
            raise PluginError(f"{title}: '{number.name}' has shape {shape}, not ({', '.join([str(n), *number.dims])})")
    return values


def quantity_report(plugin: Quantities, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> tuple[Tables, list[str]]:
    """Of one point what result.json has at the plug-in's name, and warnings, or ``PluginError``."""
    title, numbers = f"quantity '{plugin.name}'", {name: value[0] for name, value in values.items()}
    table: Tables = {number.path.partition(".")[2]: numbers[number.name].tolist() for number in plugin.numbers}
    own, warnings = said(plugin, "table"), said(plugin, "warnings")
    if own is not None:
        table = _answer(title, "table", lambda: own(points, values), dict)
    return table, [] if warnings is None else _answer(title, "warnings", lambda: warnings(points, values), list)


def _says(trait: str, *duties: str) -> Callable[[object], bool]:
    """Whether a plug-in, or its class, says a trait of its contract; not unless it does, anew where it overrides what that is about."""

    def says(plugin: object) -> bool:
        classes = (plugin if isinstance(plugin, type) else type(plugin)).__mro__
        at, *others = (next((k for k, c in enumerate(classes) if name in vars(c)), 0) for name in (trait, *duties))
        return bool(said(plugin, trait)) and at <= min(others, default=at)

    return says


#: Traits of contact laws.
renews, line_contact, is_constraint, is_foundation, _is_elementwise = map(
    _says, ("renewed", "line_contact", "constraint", "foundation", "elementwise")
)
is_hertzian = _says("hertzian", "build", "kernel")
is_elementwise_force = _says("elementwise", "parameters", "period_s")
#: Of meshers, formats, integrators, identifiers and bodies.
is_swept, of_results, finds_orbit = _says("swept", "mesh"), _says("of_results"), _says("orbit", "scheme")
is_synchronous, gives_columns = _says("synchronous", "identify"), _says("columns", "build")
has_rollers = _says("rollers", "build")


def law_params(law: ContactLaw, pairs: ContactPairs, row: str = "ball-race pair") -> np.ndarray:
    """(n, k) parameters of a contact law, or ``PluginError``; ``row`` : what a row stands for.

    Of options that are columns (m,), one number for each of m operating points, rows belong to these points in turn.
    """
    params, n = _of_contacts(law, pairs, "build"), len(pairs.curvature_a)
    if params.ndim != 2 or len(params) != n:
        rule = f"it must be ({n}, k): a row for each {row}"
        raise PluginError(f"contact law '{law.name}': build() returned parameters of shape {params.shape}; {rule}")
    return params


def reach_of(law: ContactLaw, pairs: ContactPairs) -> np.ndarray:
    """How far from touching the contacts of a law begin to carry (n,) [m], or ``PluginError``; 0 unless it says more."""
    n = len(pairs.curvature_a)
    if said(law, "reach") is None:
        return np.zeros(n)
    reach = _of_contacts(law, pairs, "reach")
    if reach.shape != (n,) or not (reach >= 0.0).all() or not np.isfinite(reach).all():
        words = f"contact law '{law.name}': reach() must return {n} finite lengths of 0 or more, one for each contact"
        raise PluginError(words)
    return reach


def _of_contacts(law: ContactLaw, pairs: ContactPairs, duty: str) -> np.ndarray:
    """What a duty returns of contacts (n,): of laws that say ``elementwise`` at once, of others for each distinct value of columns."""

    def of(law: ContactLaw, pairs: ContactPairs) -> np.ndarray:
        return _array(f"contact law '{law.name}'", duty, lambda: getattr(law, duty)(pairs))

    if not has_columns(law):
        return of(law, pairs)
    rows = np.repeat(np.arange(length(law)), len(pairs.curvature_a) // length(law))
    if _is_elementwise(law):
        return of(at_rows(law, rows), pairs)
    laws, index = distinct(law)
    parts = [np.flatnonzero(index[rows] == k) for k in range(len(laws))]
    values = np.concatenate([of(one_value, pairs.at(part)) for one_value, part in zip(laws, parts, strict=True)])
    return values[np.argsort(np.concatenate(parts))]


def law_report(law: ContactLaw, pairs: ContactPairs) -> LawReport | None:
    """The report of a renewed law on its contacts; None unless it has one."""
    report = said(law, "report")
    if not renews(law) or report is None:
        return None
    return _answer(f"contact law '{law.name}'", "report", lambda: report(pairs), LawReport)


def force_params(excitation: Excitation) -> np.ndarray:
    """(k,) parameters of an excitation, (n, k) of one whose options are columns (n,), or ``PluginError``."""
    params, n = _array(f"excitation '{excitation.name}'", "parameters", excitation.parameters), length(excitation)
    if params.ndim != 1 + (n > 0) or n not in (0, len(params)):
        shape = f"({n}, k)" if n else "(k,)"
        raise PluginError(f"excitation '{excitation.name}': parameters() returned shape {params.shape}; it must be {shape}")
    return params


def _array(plugin: str, duty: str, call: Callable[[], object]) -> np.ndarray:
    return _answer(plugin, duty, lambda: np.ascontiguousarray(call(), dtype=float), np.ndarray)


#: The speed of an excitation [r/min], default of the spin speed; None where it has none, or there is no excitation.
speed_rpm: Callable[[Excitation | None], float | None] = partial(said, name="speed_rpm")
#: Time that is integrated [s]; None, for the turns of the scene, unless the excitation says more.
duration_s: Callable[[Excitation | None], float | None] = partial(said, name="duration_s")


def changes_speed(excitation: Excitation | None) -> bool:
    """Whether an excitation runs from one speed, ``first_speed_rpm``, to another; not unless it has that."""
    return said(excitation, "first_speed_rpm") is not None


def ramp_turns(excitation: Excitation | None) -> float:
    """Turns over which the force grows from zero; 0 unless the excitation says more."""
    return float(said(excitation, "ramp_turns"))


def has_phase(excitation: Excitation | None) -> bool:
    """Whether an excitation knows the angle of its 1x component."""
    return said(excitation, "phase") is not None


def steady_form(excitation: Excitation | None) -> Excitation | None:
    """The periodic excitation on whose orbit the motion under a changing speed starts; None where there is none."""
    steady = said(excitation, "steady")
    return None if steady is None else steady()


def at_whirl(excitation: Excitation, whirl_rpm: float) -> Excitation:
    """The same force at another whirl speed [r/min]; with another ``speed_rpm`` unless the excitation says more."""
    at: Callable[[float], Excitation] | None = said(excitation, "at_whirl")
    return attrs.evolve(excitation, speed_rpm=whirl_rpm) if at is None else at(whirl_rpm)  # type: ignore[misc]
