"""How far the headline quantities of a result may be off, and by what: ``uncertainty`` of result.json.

Parts are relative changes, each with how it was found: ``numerical``, of the solver; ``hypotheses``, ``error.model``; ``data``, geometry that
is inferred, whose bearing it is, and [tolerances]; ``contact``, exact Hertz instead of the law; ``bodies``, elastic rings and balls instead of
rigid ones.  Nobody prints how loads, pressures and lives differ between bearings: there inferred numbers go to the ends of their scatter,
one by one, in the equilibrium of rigid rings under the constant loads.

JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.1.2 (squares of independent parts) and F.2.4.5 (known effects
that are not corrected widen one side).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import hypot, isfinite, pi
from typing import TYPE_CHECKING, Any, NotRequired, Protocol, TypedDict

import attrs
import numpy as np

from raceway.answers.quantities import HEADLINE, KXX, KYY, L10R, P0, PEAK_BALL_LOAD, PRELOAD, STIFFNESSES, K, Quantity, Z
from raceway.answers.quantities import KYY_TILTS_FOLLOW as FOLLOWS
from raceway.bodies.model import Equilibrium, Model, model_of, tilts_follow
from raceway.bodies.rigid_bearing import build, with_hertz
from raceway.core.ring.ring import TOLERANCE
from raceway.errors import RacewayError
from raceway.framework.estimate import Estimate, Note
from raceway.framework.shown import Fact, interval_percents, number_within
from raceway.pipeline.equilibrium import pressures, solve_equilibrium
from raceway.pipeline.error import Errors
from raceway.pipeline.plausible import Spread
from raceway.pipeline.quantities import StatedQuantities, plugins_stating, solved_point, stated_numbers
from raceway.planning.resolve import Problem
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.plugins.formats import RunResult

    class Computed(RunResult, Protocol):
        """What the intervals of a ``Result`` rest on."""

        @property
        def errors(self) -> Errors: ...
        @property
        def stated(self) -> StatedQuantities: ...
        @property
        def bodies(self) -> Tables | None: ...
        @property
        def spread(self) -> tuple[Spread | None, Note]: ...
        @property
        def tolerances(self) -> Tables | None: ...
        @property
        def geometry(self) -> Tables | None: ...
        @property
        def kyy_tilts_follow(self) -> float | None: ...
        @property
        def equivalent_stiffness_error(self) -> float | None: ...


#: How parts combine.
RULE = (
    "hypotheses, contact and bodies, whose sign is known, add on their side; this sum, numerical and data, on each side the root of "
    "the sum of squares; parts that are not known are left out"
)
#: Parts whose sign is known, with their words on screens.
_SIGNED = {"hypotheses": "hypotheses", "contact": "exact Hertz", "bodies": "rings and balls elastic"}
#: Notes on contacts or hypotheses that change nothing.
_NOTHING = (Estimate.HERTZ_ITSELF, Estimate.BEYOND_HERTZ, Estimate.NOTHING_TURNS, Estimate.HYPOTHESES_STATED)
#: Share of the interval below which a part is not told; of its smaller side, to which the value is shown.
_TOLD, _SHOWN = 0.1, 0.1

Range = tuple[float, float]


class Cause(TypedDict):
    """Relative change by one cause, None where it is not known, and how it was found; ``of`` has the causes of data by their names."""

    low: float | None
    high: float | None
    how: str
    part: NotRequired[str]
    remedy: NotRequired[str]
    of: NotRequired[list[Cause]]


def combined(parts: Mapping[str, Cause]) -> Range:
    """The interval of parts by ``RULE``, relative; 0 lies inside."""
    intervals = {name: change for name, part in parts.items() if (change := _change(part)) is not None}
    same_sign = [_with_zero(intervals.pop(name)) for name in _SIGNED if name in intervals]
    return _squares([(sum(low for low, _ in same_sign), sum(high for _, high in same_sign)), *intervals.values()])


def of_ratio(base: ReadTables, other: ReadTables, same: bool) -> Range:
    """Interval of other / base, relative, from the intervals of both.

    Numerical errors of both add as squares, as data of two bearings (not ``same``) do.  Of other causes the difference counts: what changes
    both by the same factor leaves the ratio.  How far the ratio itself depends on it is not estimated.
    """
    causes: dict[str, Cause] = {}
    for name, first, second in ((name, part, other["parts"][name]) for name, part in base["parts"].items()):
        if (a := _change(first)) is not None and (b := _change(second)) is not None:
            alone = name == "numerical" or (name == "data" and not same)
            ends = (-hypot(b[0], a[1]), hypot(b[1], a[0])) if alone else (b[0] - a[0], b[1] - a[1])
            causes[name] = _part(ends, "")
    return combined(causes)


def _with_zero(change: Iterable[float]) -> Range:
    ends = 0.0, *change
    return min(ends), max(ends)


def _squares(changes: Iterable[Iterable[float]]) -> Range:
    sides = [_with_zero(change) for change in changes]
    return -hypot(*(low for low, _ in sides)), hypot(*(high for _, high in sides))


def _change(part: Cause) -> Range | None:
    return None if part["low"] is None or part["high"] is None else (part["low"], part["high"])


def _part(change: Sequence[float] | None, how: str) -> Cause:
    low, high = change or (None, None)
    return {"low": low, "high": high, "how": str(how)}


def uncertainty_table(result: Computed) -> Tables:
    """The table: quantity -> value, unit, low, high, relative, parts, rule; None with its reason in ``why``."""
    table, why, unclear = dict[str, Tables | None](), dict[str, str](), ", ".join(result.errors.unresolved)
    lives = result.stated.missing.get(L10R.path.partition(".")[0], "no life is computed")
    absent = {K: "the scene is static", L10R: lives, PRELOAD: "the bearing has no preload"}
    scatters, hertz = _at_scatters(result), dict[str, float]()
    if result.errors.contact.estimate is Estimate.AGAINST_HERTZ:  # the law is not Hertz's
        own, other = _rest_numbers(result.model, result.equilibrium), _rigid_numbers(result.model, result.model.problem)
        hertz = {name: other[name] / value - 1.0 for name, value in own.items() if name in other}
    elastic = elastic_change(result.model, result.equilibrium) if result.bodies is None else {}
    for quantity in HEADLINE:
        value, name = quantity.of(result), quantity.name
        table[name] = None
        if value is None:
            why[name] = absent.get(quantity, "supports.tilt is locked")
        elif not isfinite(value) or not value:
            why[name] = f"{value:g} has no relative change"
        elif quantity is K and (unclear or (result.equivalent_stiffness_error or 0.0) > abs(value)):
            why[name] = f"not resolved: the error of Z ({unclear or 'total'}) is as large as K"
        if name in why:
            continue
        # K changes as the radial stiffness does.
        static = (KYY if result.kyy_tilts_follow is None else FOLLOWS).name if quantity is K else name
        data = [*_geometry(result, quantity, scatters)]
        if (band := result.tolerances) is not None:
            names = {PEAK_BALL_LOAD: "largest_ball_load", L10R: L10R.name}
            at = band["quantities"].get(names.get(quantity, quantity.symbol)) or {"value": 0.0}
            ends = [(at[end] - at["value"]) / abs(at["value"]) for end in ("low", "high") if at["value"]]
            how = "95 % to first order" if ends else band["why"] or "no derivative"
            data.append(("tolerances", _part(ends or None, how)))
        each: list[Cause] = [{"part": word, **part} for word, part in data]
        intervals = [change for part in each if (change := _change(part)) is not None]
        how = "; ".join(f"{word}: {part['how']}" for word, part in data) or "the scene states its geometry"
        parts: dict[str, Cause] = {
            "numerical": _numerical(result, quantity),
            "hypotheses": _hypotheses(result, name, static),
            "data": {**_part(_squares(intervals) if intervals else None, how), "of": each},
            "contact": _contact(result, quantity, hertz.get(static)),
            "bodies": _bodies(elastic, KYY.name if quantity in (K, FOLLOWS) else name),
            **_added_mass(result, quantity),
        }
        low, high = combined(parts)
        if low == high or (quantity is PRELOAD and not intervals):
            why[name] = f"not estimated: {', '.join(word for word, part in parts.items() if part['low'] is None)}"
            continue
        low = low if quantity in STIFFNESSES else max(low, -1.0)
        table[name] = {
            "value": float(value), "unit": quantity.unit, "low": value + low * abs(value), "high": value + high * abs(value),
            "relative": [low, high], "parts": parts, "rule": RULE,
        }  # fmt: skip
    return {**table, "why": why}


def stated(quantity: Quantity, result: Mapping[str, Any]) -> Fact:
    """Label, value with the digits that its interval deserves, and the interval with its parts, from the content of result.json."""
    entry, why = result["uncertainty"][quantity.name], result["uncertainty"]["why"].get(quantity.name, "")
    if entry is None:
        return quantity.label, "not resolved" if quantity is K else quantity.text(quantity.of(result)), why
    value, (low, high) = quantity.read(entry["value"]), entry["relative"]
    least = min(filter(None, (-low, high)), default=0.0)
    return quantity.label, number_within(value, _SHOWN * least * abs(value), quantity.read_unit), interval(entry)


def interval(entry: ReadTables) -> str:
    """An interval and its parts in a line, the largest first."""
    (low, high), parts = entry["relative"], entry["parts"]
    causes: dict[str, Cause] = {part["part"]: part for part in parts["data"]["of"]} or {"tolerances": parts["data"]}
    causes |= {words: parts[name] for name, words in _SIGNED.items()} | {"numerical": parts["numerical"]}
    causes |= {name: parts[name] for name in parts if name == "mass scaling"}
    changes = {words: _change(part) for words, part in causes.items()}
    known = {words: change for words, change in changes.items() if change is not None}
    sizes = {words: max(map(abs, change)) for words, change in known.items()}
    largest = [words for words in sorted(sizes, key=lambda words: -sizes[words]) if sizes[words] > _TOLD * max(-low, high)]
    each = ", ".join(f"{words} {interval_percents(known[words], '')[:-2]}" for words in largest)
    unknown = ", ".join(words for words in changes if words not in known)
    return f"{interval_percents((low, high))}: {each}{unknown and f'; not estimated: {unknown}'}"


def _numerical(result: Computed, quantity: Quantity) -> Cause:
    errors = result.errors
    if quantity is K or (quantity in (PEAK_BALL_LOAD, P0) and result.simulation is not None):
        if errors.total.size is None:
            return _part(None, errors.total.how)
        calibration = (errors.contact.size or 0.0) if result.model.traits.calibrated else 0.0
        size = max(errors.total.size - calibration, 0.0) * (Z.of(result) / abs(K.of(result)) if quantity is K else 1.0)
        return _part((-size, size), "error.total, over K" if quantity is K else "error.total, of the motion")
    if errors.mesh.size is None and result.bodies is not None:
        return _part(None, errors.mesh.how)
    size = TOLERANCE + (errors.mesh.size or 0.0)
    return _part((-size, size), "residual of the equilibrium, error.mesh")


def _hypotheses(result: Computed, *names: str) -> Cause:
    """Of the first name that ``error.model`` has."""
    spread, note = result.spread
    if spread is None:
        return _part((0.0, 0.0) if note.estimate in _NOTHING else None, note)
    if not spread.rows:
        return _part((-spread.bound, spread.bound), note)
    ranges = spread.ranges
    name = next((name for name in names if ranges.get(name) is not None), None)
    return _part(None, "not in error.model") if name is None else _part(ranges[name], f"error.model.{name}")


def _contact(result: Computed, quantity: Quantity, hertz: float | None) -> Cause:
    contact = result.errors.contact
    size, note, estimate = contact.size, contact.how, contact.estimate
    if estimate in _NOTHING or size is None:
        return _part((0.0, 0.0) if estimate in _NOTHING else None, note)
    if estimate is Estimate.AGAINST_HERTZ:
        return _part(None if hertz is None else (hertz, hertz), "exact Hertz in the equilibrium of rigid rings")
    if quantity not in STIFFNESSES:
        return _part(None, "known of stiffnesses alone")
    # Without overlap a contact is stiffer.
    return _part((-size, size) if result.model.traits.calibrated else (0.0, size / max(1.0 - size, 1e-9)), note)


def _bodies(elastic: Mapping[str, float] | str, name: str) -> Cause:
    if not elastic:
        return _part((0.0, 0.0), "elastic as computed")
    if isinstance(elastic, str) or name not in elastic:
        return _part(None, elastic if isinstance(elastic, str) else "known of stiffnesses alone")
    return _part(_with_zero([elastic[name]]), "walls below the grooves, and balls")


def _added_mass(result: Computed, quantity: Quantity) -> dict[str, Cause]:
    """Of mass that is added to elements for a larger explicit step: its kinetic energy beyond that of the ring as a rigid body.

    The ring's part is in the mass that K is identified with.  What moves with the balls lowers K by w^2 times the mass that has
    their energy at the ring's speed.
    """
    scaling = (result.bodies or {}).get("mass_scaling")
    if scaling is None or quantity is not K or result.simulation is None:
        return {}
    record, w = result.simulation.record, 2.0 * pi * result.model.excitation.frequency_hz
    ring = 0.5 * (record.velocity[:, 1:3] ** 2).sum(axis=1).mean()
    extra = record.energies["added mass"].mean() / ring - scaling["ring_gains"]["y_kg"]
    share = float(abs(extra) * w**2 / abs(K.of(result)))
    how = f"{100.0 * scaling['moving_share']:.2g} % of the moving mass is added; kinetic energy of what does not move with the ring"
    return {"mass scaling": _part((0.0, share), how)}


def _geometry(result: Computed, quantity: Quantity, scatters: Mapping[str, Range]) -> Iterator[tuple[str, Cause]]:
    geometry = result.geometry
    if geometry is not None and quantity not in STIFFNESSES:
        yield "inferred geometry", _part(scatters.get(quantity.name), "inferred numbers at the ends of their uncertainties")
        for part in geometry["data"]:
            if part["part"] != "inferred geometry":
                yield part["part"], {**_part(None, "known of stiffnesses alone"), "remedy": part["remedy"]}
    elif geometry is not None:
        for part in geometry["data"]:
            change = part["axial" if quantity is KXX else "radial"]
            yield part["part"], {**_part(change, part["why"]), "remedy": part["remedy"]}


def _at_scatters(result: Computed) -> dict[str, Range]:
    """Changes of numbers at rest by inferred numbers at the ends of their scatter."""
    inferences, problem = (result.geometry or {}).get("inferred", {}), result.model.problem
    scatters = {key: fact["scatter"] for key, fact in inferences.items() if fact["scatter"] and "." not in key}
    # Rings that grow would be solved for at each of them.
    still = attrs.evolve(problem, kinematics=attrs.evolve(problem.kinematics, ring_growth=False))
    base, changes = _rigid_numbers(result.model, still), dict[str, list[Range]]()
    for key, scatter in scatters.items():
        number = getattr(problem.bearing, key)
        whole = isinstance(number, int)
        step = 1.0 / number if whole else scatter  # a ball more and a ball less
        numbers = [number * (1.0 + by) for by in (-step, step)]
        ends = [_rigid_numbers(result.model, still, **{key: round(value) if whole else value}) for value in numbers]
        for name in set(base).intersection(*ends):
            change = _with_zero(scatter / step * (end[name] / base[name] - 1.0) for end in ends)
            changes.setdefault(name, []).append(change)
    return {name: _squares(each) for name, each in changes.items() if len(each) == len(scatters)}


def _rigid_numbers(model: Model, problem: Problem, **numbers: Any) -> dict[str, float]:
    """Of rigid rings with Hertz's law and other numbers of [bearing], of rollers with their own law; empty without an equilibrium."""
    try:
        problem = attrs.evolve(problem, bearing=attrs.evolve(problem.bearing, **numbers))
        if problem.traits.line_contacts:
            other = model_of(problem, model.plan)
        else:
            bearing = build(with_hertz(problem), model.plan)
            other = Model(with_hertz(problem), model.plan, bearing, bearing.system)
        return _rest_numbers(other, solve_equilibrium(other))
    except (RacewayError, ValueError, ArithmeticError):  # LinAlgError is a ValueError
        return {}


def _rest_numbers(model: Model, equilibrium: Equilibrium) -> dict[str, float]:
    """Headline quantities at rest that are no zeros."""
    lives = stated_numbers(solved_point(model, equilibrium, None), plugins_stating(model.problem, L10R.name))
    k, force = equilibrium.stiffness, equilibrium.contact_force
    numbers = {KXX.name: k[0, 0], KYY.name: k[1, 1], FOLLOWS.name: tilts_follow(k, model.problem.supports.tilt)}
    numbers |= {PEAK_BALL_LOAD.name: force.max(), P0.name: pressures(model, force).max()}
    numbers |= {name: value[0] for name, value in lives.items() if name == L10R.name}
    return {name: float(value) for name, value in numbers.items() if value is not None and isfinite(value) and value}


#: Structural compliance times E' and wall thickness of a ring, times E' and diameter of a ball.
_RING, _BALL = 0.41, 0.91
#: How well the change is known, relative.
_WITHIN = 0.1
#: Steps to a ball's load and contact angle; least sine of that on the way.
_ITERATIONS, _LEAST = 20, 1e-3


def elastic_change(model: Model, equilibrium: Equilibrium) -> dict[str, float] | str:
    """Relative change of ``kxx`` and ``kyy`` on rigid seats, at most; or why there is none.

    model : rigid bodies;  equilibrium : its static state

    Half-spaces under a Hertz contact give way by more than a ring's wall on a rigid seat and a ball of finite size.  The difference
    c, the structural compliance of ``bodies.kind = "condensed"`` with its sign changed, is that of a layer: a ring's wall t below
    its groove takes ``_RING`` cos^2(alpha) / (E' t), a ball ``_BALL`` / (E' D) for both of its contacts (E' = E / (1 - nu^2)).  Each
    ball keeps its axial force Q sin(alpha) and the radial distance s cos(alpha) of its groove centres, and approaches by c Q less:
    axially its stiffness is k sin^2(alpha) + (Q / s) cos^2(alpha), radially that with sine and cosine exchanged, 1 / k = h - c
    (h Hertz's compliance).  Seats that give way change the sign: ``supports.outer_seat`` and ``inner_seat`` of condensed bodies.

    Fitted to condensed bodies of 23 bearings of eight series under 0.5, 2 and 8 % of C0: their changes are met within ``_WITHIN`` of
    themselves (``python -m checks uncertainty``).
    """
    b, z = model.problem.bearing, model.system.ball_count
    if not model.traits.contacts_alone:
        return f"bodies.kind = '{model.problem.bodies.name}'"
    if b.bore is None or b.outer_diameter is None or not b.equal_rows:
        return "needs `bearing.bore` and `bearing.outer_diameter` of equal rows"
    ring, ball = (material.young / (1.0 - material.poisson**2) for material in (b.rings, b.balls))
    walls = (
        0.5 * (b.pitch_diameter - b.ball_diameter - b.bore),
        0.5 * (b.outer_diameter - b.pitch_diameter - b.ball_diameter),
    )
    loads = equilibrium.contact_force[:z], equilibrium.contact_force[z:]
    loaded = (loads[0] > 0.0) & (loads[1] > 0.0)
    if not loaded.any() or min(walls) <= 0.0:
        return "no loaded ball" if min(walls) > 0.0 else "no wall below the grooves"
    inner, outer = (load[loaded] for load in loads)
    angle = np.abs(0.5 * (equilibrium.angle_inner + equilibrium.angle_outer)[loaded])
    thin = _RING * np.cos(angle) ** 2 / ring * sum(1.0 / wall for wall in walls) + _BALL / (ball * b.ball_diameter)

    def approach(load: np.ndarray) -> np.ndarray:
        """Of both races [m], in the ratio that the two loads of a ball have now."""
        return np.asarray(model.inner.approach(inner / mean * load) + model.outer.approach(outer / mean * load))

    rest, mean = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter, 0.5 * (inner + outer)
    push, distance = mean * np.sin(angle), (rest + approach(mean)) * np.cos(angle)
    # A ball that is loaded radially keeps its load instead, and its angle: there the steps below would not converge.
    steep = rest * np.tan(angle) ** 2 > approach(mean)

    def stiffness(c: np.ndarray) -> np.ndarray:
        """Axial and radial, of all loaded balls [N/m]."""
        load, turned = mean, angle
        for _ in range(_ITERATIONS):
            length = rest + approach(load) - c * load
            turned = np.where(steep, np.arccos(np.minimum(distance / length, 1.0)), angle)
            load = np.where(steep, push / np.maximum(np.sin(turned), _LEAST), mean)
        normal, across = 1.0 / (approach(load) / (1.5 * load) - c), load / length
        sine, cosine = np.sin(turned) ** 2, np.cos(turned) ** 2
        return np.array([(normal * sine + across * cosine).sum(), (normal * cosine + across * sine).sum()])

    with np.errstate(invalid="ignore"):
        change = (stiffness(thin) / stiffness(0.0 * thin) - 1.0) * (1.0 + _WITHIN)
    if not np.isfinite(change).all():
        return "rings give way by more than the distance of their grooves"
    return {"kxx": float(change[0]), "kyy": float(change[1])}
