"""Derivatives of a result by the continuous keys of its scene, and its band over tolerances to first order.

Notes
-----
The collocated orbit u solves R(u, p) = 0 with the exact tangent that Newton's iteration and branches use.  Its derivative is one
linear problem, du/dp = -R_u^-1 dR/dp round the span, dR/dp at the fixed orbit along the derivatives of the model's arrays; the 1x line
is then differentiated along u + h du/dp, p + h.  With dashpots the rates of the balls follow the orbit, and tangents lack how
their forces turn with the contacts: what is left of dR/dp along the line is then taken off again, until the derivative stays.

Over tolerances numbers are even in their ranges and independent, as ``raceway band`` takes them; an answer is the nominal one plus the
sum of its derivatives by each number times what that lies off.  The density of the sum is the convolution of even ones, from which the
limits of 95 % are taken.  Tolerances that bend the answer within their range need ``raceway band``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, tilts_follow
from raceway.core.periodic.collocation import Path, Problem, Solved, renew, stiff
from raceway.core.periodic.intervals import Change, Eliminated, condense, imbalances, spread
from raceway.core.periodic.search import PeriodicMotion, find, problem_of
from raceway.core.periodic.steady import growth_of_disturbances, orbit_tables, refuse, synchronous_response
from raceway.core.record import Schedule
from raceway.core.ring.kernels.layout import CAGE, DAMPING, TIME_CONSTANT
from raceway.core.ring.system import System, by_address, surrogate
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.shown import Fact, race_words, tilt_words
from raceway.out.quantities import AMPLITUDE, DIFFERENTIABLE, KXX, KYY, KYY_TILTS_FOLLOW, LARGEST_BALL_LOAD, C, K, X, read_in
from raceway.pipeline.equilibrium import race_of
from raceway.pipeline.static_gradient import Direction, NoDerivative, StaticGradient, static_gradient
from raceway.scene.changes import Key, key_of
from raceway.scene.tolerance import stated_tolerances, tolerances_of
from raceway.storage.tables import Tables

#: Samples of a turn with which the force's period is checked; tolerance of the orbit where the scene's integrator has none.
_SAMPLES, _TOLERANCE = 360, 1e-8
#: Largest step over the number at the key, and over the step of the static differences: errors fall with its square.
_LARGEST, _SHARE = 3e-5, 0.03
#: Turns of orbit and rates; what the last one still changes, over the whole: the next one is a tenth of it or less; rounding of
#: a motion over its size.
_RATES, _LEFT, _ROUNDING = 12, 1e-7, 1e-11
_NO_PLACE = "the balls find no place between the races"
#: Part of |Z| below which w C is no number that an orbit resolves.
_RESOLVED = 1e-6
#: Share of the answers in a band; points of a density.
_COVERAGE, _POINTS = 0.95, 4001


@attrs.frozen(eq=False)
class _MotionGradient:
    """Derivatives of the 1x line of the steady orbit by the number at one key.

    Attributes
    ----------
    dynamic_stiffness : complex, of Z [N/m];  equivalent_stiffness : of K [N/m];  equivalent_damping : of C [N s/m]
    amplitude : of the 1x line along the force [m]
    """

    dynamic_stiffness: complex
    equivalent_stiffness: float
    equivalent_damping: float
    amplitude: float

    @property
    def nothing(self) -> bool:
        """Whether the key changes nothing of the orbit."""
        return not (self.dynamic_stiffness or self.equivalent_stiffness or self.equivalent_damping or self.amplitude)


@attrs.define(eq=False)
class SteadyOrbit:
    """The steady orbit of a model under its excitation, and how its 1x line depends on the scene.

    Attributes
    ----------
    orbit : that is taken, with others beside it
    """

    model: Model
    orbit: PeriodicMotion

    @property
    def solved(self) -> Solved:
        return self.orbit.refined.solved

    @classmethod
    def of(cls, model: Model, equilibrium: Equilibrium) -> SteadyOrbit:
        """Search for it.

        Raises
        ------
        SceneError
            An excitation or bodies that have no steady orbit of the force's period.
        ConvergenceError
            None was found.
        """
        period = model.excitation.period_s
        if period is None:
            why = "a force whose speed changes has no steady orbit: take 'unidirectional' or 'bidirectional'"
            raise SceneError.at("excitation.kind", model.excitation.name, why)
        refuse(model.system, Schedule(period / _SAMPLES, _SAMPLES, 1))
        system = by_address(surrogate(model.system))
        q = equilibrium.displacement
        problem = problem_of(system, 2.0 * np.pi / period, q)
        if system.scalars[CAGE] != 0.0 and not problem.symmetry.pitch:
            why = "balls that orbit pass at another frequency than the force: no motion repeats itself every turn"
            raise SceneError.at("kinematics.orbiting", True, why)
        tolerance = float(getattr(model.problem.integrator.method, "tolerance", _TOLERANCE))
        return cls(model, find(problem, q, equilibrium.stiffness_rows_held, min(tolerance, _TOLERANCE)))

    @property
    def warning(self) -> str:
        """What a person must know of an orbit that is unstable; empty where it is not."""
        table = orbit_tables([self.orbit])[0]
        if table["stable"]:
            return ""
        return f"the steady orbit is unstable, {growth_of_disturbances(table)}: a ring leaves it, and what holds of it holds of no lasting motion"

    @cached_property
    def line(self) -> np.ndarray:
        """(4,) Re Z, C and K [N/m, N s/m, N/m], amplitude [m]."""
        return _line(self.solved, self.model.mass_used)

    def gradient(self, statics: StaticGradient) -> _MotionGradient:
        """By the key of a static gradient, with whose displacement coordinates that are held move.

        Raises
        ------
        NoDerivative
            There is none, with the reason.
        """
        direction = statics.direction
        step = _LARGEST * abs(statics.key.value) or direction.first_step
        if statics.step:
            step = min(step, _SHARE * statics.step)
        try:
            real, damping, stiffness, amplitude, speed = self._differentiated(direction, step, statics.displacement)
        except ConvergenceError as why:
            raise NoDerivative(f"the neighbouring orbits have no balance: {why}") from None
        omega = self.solved.problem.speed
        imag = damping * omega + self.line[1] * speed
        return _MotionGradient(complex(real, imag), float(stiffness), float(damping), float(amplitude))

    def _differentiated(self, direction: Direction, step: float, displacement: np.ndarray) -> np.ndarray:
        """(5,) derivatives of ``line`` and of the speed."""
        problems = {k: self._problem(direction, k * step) for k in (-1, 1)}
        solved, held = self.solved, np.where(self.model.system.free > 0.0, 0.0, displacement)
        path, weight, speed = solved.path, solved.problem.weight, solved.problem.speed
        lagging = any(solved.problem.system.scalars[entry] != 0.0 for entry in (DAMPING, TIME_CONSTANT))
        faster = (problems[1].speed - problems[-1].speed) / (2.0 * step)
        rounding, first = _ROUNDING * np.abs(path.a / weight).max() / step, 0.0
        moved = {
            k: attrs.evolve(path, q=path.q + k * step * held, rate=path.rate * (problem.speed / speed))
            for k, problem in problems.items()
        }
        for turn in range(_RATES):
            slope = (_imbalance(problems[1], moved[1]) - _imbalance(problems[-1], moved[-1])) / (2.0 * step)
            if turn == 0 and not slope.any() and not held.any() and faster == 0.0:
                return np.zeros(5)
            change = self._change(slope)
            moved = {k: _moved(neighbour, change, k * step) for k, neighbour in moved.items()}
            size = float(np.abs(change.a / weight).max())
            first = first or size
            if not lagging or turn > 0 and size <= max(_LEFT * first, rounding):
                break
            moved = {k: attrs.evolve(neighbour, rate=_rates(problems[k], neighbour)) for k, neighbour in moved.items()}
        lines = {
            k: _line(attrs.evolve(solved, problem=problems[k], path=neighbour), self._mass(problems[k].system))
            for k, neighbour in moved.items()
        }
        return np.append((lines[1] - lines[-1]) / (2.0 * step), faster)

    def _mass(self, system: System) -> float:
        """``Model.mass_used`` of a neighbouring system."""
        return float(system.mass[1, 1]) if self.model.mass_used else 0.0

    def _problem(self, direction: Direction, by: float) -> Problem:
        """The boundary-value problem of a neighbouring model, on the same mesh of angles."""
        problem = self.solved.problem
        speed = problem.speed + by * direction.speed
        return attrs.evolve(problem, system=direction.moved(problem.system, by), speed=speed, clock=speed)

    def _change(self, slope: np.ndarray) -> Change:
        """du/dp from dR/dp (m s, 5)."""
        problem, path = self.solved.problem, self.solved.path
        n = len(problem.free)
        out = _condensed(problem, attrs.evolve(path, ball=path.ball.copy()), slope)
        # What is left of the balance of forces is no part of the derivative.
        out.stages[:, 2 * n] = out.transfer[:, 2 * n] = 0.0
        first = np.linalg.solve(problem.closing - out.span_transfer[:, : 2 * n], out.span_transfer[:, 2 * n + 1])
        change = Change(np.zeros_like(path.q), np.zeros_like(path.v), np.zeros_like(path.a))
        spread(problem.free, out, first, 1.0, change)
        return change


def _condensed(problem: Problem, path: Path, *slope: np.ndarray) -> Eliminated:
    """The path's intervals with their inner unknowns eliminated."""
    out = problem.eliminated(path.nodes)
    samples = path.samples(problem.push(path.nodes), *slope)
    if condense(problem.equations, problem.mesh(path.nodes), samples, out, np.zeros(3)) < path.intervals:
        raise ConvergenceError(_NO_PLACE)
    return out


def _imbalance(problem: Problem, path: Path) -> np.ndarray:
    push = problem.push(path.nodes)
    out = np.zeros_like(push)
    if imbalances(problem.equations, problem.mesh(path.nodes), path.samples(push), out) < path.intervals:
        raise ConvergenceError(_NO_PLACE)
    return out


def _moved(path: Path, change: Change, by: float) -> Path:
    return attrs.evolve(path, q=path.q + by * change.q, v=path.v + by * change.v, a=path.a + by * change.a)


def _rates(problem: Problem, path: Path) -> np.ndarray:
    """Rates of the balls along a path."""
    copy = attrs.evolve(path, ball=path.ball.copy(), rate=path.rate.copy())
    _condensed(problem, copy)
    renew(problem, copy, stiff(problem, copy))
    return copy.rate


def _line(solved: Solved, mass: float) -> np.ndarray:
    z, amplitude = synchronous_response(solved)
    omega = solved.problem.speed
    return np.array([z.real, z.imag / omega, z.real + mass * omega**2, amplitude])


@attrs.frozen(eq=False)
class Gradient:
    """Derivatives by one key: of the equilibrium, and of the steady orbit where the scene has an excitation."""

    statics: StaticGradient
    motion: _MotionGradient | None

    @property
    def nothing(self) -> bool:
        """Whether the key changes nothing at all."""
        return self.statics.step == 0.0 and (self.motion is None or self.motion.nothing)


@attrs.frozen(eq=False)
class Gradients:
    """Derivatives of an equilibrium, and of the steady orbit about it.

    Raises
    ------
    SceneError
        Bodies whose contacts are pressures at surface points, or are not compiled.
    """

    model: Model
    equilibrium: Equilibrium

    def __attrs_post_init__(self) -> None:
        traits = self.model.traits
        if not (traits.compiled and traits.resultants):
            why = "surface points open and close one by one: their forces have no derivative. Take contact.discretisation = 'resultant'"
            raise SceneError.at("bodies.kind", self.model.problem.bodies.name, f"{why} on rigid or condensed bodies")

    @cached_property
    def orbit(self) -> SteadyOrbit | None:
        """The steady orbit, searched for once; None in a static scene.

        Raises
        ------
        SceneError, ConvergenceError
            The force has none, or none was found.
        """
        return None if self.model.excitation is None else SteadyOrbit.of(self.model, self.equilibrium)

    def by(self, key: Key) -> Gradient:
        """By one key.

        Raises
        ------
        NoDerivative
            There is none, with the reason.
        """
        statics = static_gradient(self.model, self.equilibrium, key)
        return Gradient(statics, None if self.orbit is None else self.orbit.gradient(statics))

    def by_path(self, path: str) -> Gradient:
        """By the key of a path, such as "load.axial".

        Raises
        ------
        SceneError
            No continuous key, or one without a derivative.
        """
        try:
            return self.by(key_of(self.model.scene, path))
        except NoDerivative as why:
            raise SceneError.at(path, None, str(why)) from None


def values(model: Model, equilibrium: Equilibrium, orbit: SteadyOrbit | None) -> dict[str, float]:
    """The numbers that a scene has, by their symbols: of the steady orbit, and at rest."""
    numbers: dict[str, float] = {}
    if orbit is not None:
        real, damping, stiffness, amplitude = orbit.line.tolist()
        numbers |= {K.symbol: stiffness, AMPLITUDE.symbol: amplitude}
        if resolved(real, damping * orbit.solved.problem.speed):
            numbers[C.symbol] = damping
    numbers |= _at_rest(equilibrium, equilibrium)
    if (follows := tilts_follow(equilibrium.stiffness, model.problem.supports.tilt)) is not None:
        numbers[KYY_TILTS_FOLLOW.symbol] = follows
    return {name: numbers[name] for name in DIFFERENTIABLE if name in numbers}


def resolved(real: np.ndarray | float, imag: np.ndarray | float) -> np.ndarray:
    """Whether an orbit of this Z [N/m] has a damping that is a number."""
    return np.abs(imag) > _RESOLVED * np.abs(real)


def described(name: str, value: float, words: dict[str, str]) -> Tables:
    """A number as JSON files hold it; ``words`` as ``definitions`` has them."""
    return {"value": value, "unit": DIFFERENTIABLE[name].unit, "definition": words[name]}


def definitions(model: Model, equilibrium: Equilibrium) -> dict[str, str]:
    """What each number of ``values`` is."""
    inner, outer = equilibrium.contact_force.reshape(2, -1).max(axis=1).tolist()
    return {
        **{symbol: quantity.words for symbol, quantity in DIFFERENTIABLE.items()},
        KYY_TILTS_FOLLOW.symbol: f"radial, {tilt_words(model.problem.supports.tilt)}: tilts follow, x and z held",
        LARGEST_BALL_LOAD.symbol: f"static, {race_words(race_of(inner, outer))}; the larger of both",
    }


def derivatives(model: Model, equilibrium: Equilibrium, gradient: Gradient) -> dict[str, float]:
    """Of the same, by the number at the gradient's key."""
    statics, motion = gradient.statics, gradient.motion
    slopes: dict[str, float] = {}
    if motion is not None:
        slopes |= {quantity.symbol: getattr(motion, quantity.name) for quantity in (K, C, AMPLITUDE)}
    slopes |= _at_rest(equilibrium, statics)
    if (tilt := model.problem.supports.tilt) != "locked":
        by = float(statics.key.path == "supports.tilt")
        slopes[KYY_TILTS_FOLLOW.symbol] = _slope_with_tilts(equilibrium.stiffness, statics.stiffness, tilt, by)
    return slopes


def _at_rest(equilibrium: Equilibrium, state: Equilibrium | StaticGradient) -> dict[str, float]:
    """The numbers that every scene has, of the equilibrium or of its slopes."""
    return {
        KXX.symbol: float(state.stiffness[0, 0]),
        KYY.symbol: float(state.stiffness[1, 1]),
        X.symbol: float(state.displacement[0]),
        LARGEST_BALL_LOAD.symbol: float(state.contact_force[np.argmax(equilibrium.contact_force)]),
    }


def _slope_with_tilts(stiffness: np.ndarray, slope: np.ndarray, tilt: float | str, by: float) -> float:
    """Of kyy_tilts_follow where the stiffness (5, 5) moves with ``slope``, and the shaft's against tilts with ``by``."""
    tilts = stiffness[3:, 3:] + (tilt if isinstance(tilt, float) else 0.0) * np.eye(2)
    back = np.linalg.pinv(tilts)
    row_weights, right = np.r_[1.0, -stiffness[1, 3:] @ back], np.r_[1.0, -back @ stiffness[3:, 1]]
    return float(row_weights @ (slope[np.ix_([1, 3, 4], [1, 3, 4])] + by * np.diag([0.0, 1.0, 1.0])) @ right)


def first_order_band(
    model: Model, equilibrium: Equilibrium, tolerances: Iterable[str] | Mapping[str, str] = ()
) -> Tables | None:
    """The table ``tolerances`` of result.json, of the scene's own tolerances or of others; None without any.

    Returns
    -------
    quantities : name -> value, unit, definition, low, high, and ``shares`` of the variance by key;  left_out : keys without a derivative, with reasons
    why : why there are no quantities, or none of the motion; empty else
    """
    scene = model.scene
    if not tolerances and "tolerances" not in scene.source:
        return None
    ranges = tolerances_of(scene, tolerances or stated_tolerances(scene))
    try:
        gradients = Gradients(model, equilibrium)
    except SceneError as refusal:
        return {"quantities": {}, "left_out": [], "why": refusal.mistakes[0].message}
    orbit, why = None, ""
    try:
        orbit = gradients.orbit
    except (SceneError, ConvergenceError) as failure:
        why = f"at rest only: {failure.mistakes[0].message if isinstance(failure, SceneError) else failure}"
    words, slopes, left_out = definitions(model, equilibrium), {}, []
    for tolerance in ranges:
        key = tolerance.key
        try:
            statics = static_gradient(model, equilibrium, key)
            gradient = Gradient(statics, None if orbit is None else orbit.gradient(statics))
        except NoDerivative as reason:
            left_out.append({"key": key.path, "reason": str(reason)})
            continue
        slopes[key.path] = tolerance.low - key.value, tolerance.high - key.value, derivatives(model, equilibrium, gradient)
    quantities = {}
    for name, value in values(model, equilibrium, orbit).items():
        ends = [sorted(slope[name] * end for end in (low, high)) for low, high, slope in slopes.values()]
        low, high = limits(ends)
        widths = np.array([(above - below) ** 2 for below, above in ends])
        shares = widths / widths.sum() if widths.any() else widths
        quantities[name] = {
            **described(name, value, words),
            "low": value + low,
            "high": value + high,
            "shares": dict(zip(slopes, shares.tolist(), strict=True)),
        }
    return {"quantities": quantities, "left_out": left_out, "why": why}


def tolerance_rows(band: Tables | None) -> list[Fact]:
    """The band over the scene's tolerances to first order, as rows of a screen; of each answer the tolerance that makes most of it."""
    if not band:
        return []
    rows: list[Fact] = [("Tolerances, 95 % to first order", "", band["why"])]
    for name, quantity in band["quantities"].items():
        (low, unit), (high, _) = (read_in(quantity[end], quantity["unit"]) for end in ("low", "high"))
        key, share = max(quantity["shares"].items(), key=lambda item: item[1], default=("", 0.0))
        remarks = [f"{100.0 * share:.0f} % of the variance by {key}"] if share else []
        remarks += [quantity["definition"]] if name in ("kyy", "kyy_tilts_follow", "largest_ball_load") else []
        rows.append((name.replace("_", " "), f"{low:.5g} to {high:.5g} {unit}", "; ".join(remarks)))
    rows += [("", "", f"without {left_out['key']}: {left_out['reason']}") for left_out in band["left_out"]]
    return rows


def limits(ends: Sequence[Sequence[float]], share: float = _COVERAGE) -> tuple[float, float]:
    """Limits of a share of the sum of independent numbers that are even between their ends, (d, 2); 0 of none."""
    middle = sum(0.5 * (low + high) for low, high in ends)
    halves = [0.5 * (high - low) for low, high in ends if high > low]
    if not halves:
        return middle, middle
    reach = sum(halves)
    x = np.linspace(-reach, reach, _POINTS)
    # The distribution of one, then its mean over each of the others in turn.
    below = np.clip((x + halves[0]) / (2.0 * halves[0]), 0.0, 1.0)
    for half in halves[1:]:
        integral = np.concatenate([[0.0], np.cumsum(0.5 * (below[1:] + below[:-1]) * np.diff(x))])
        ahead = np.interp(x + half, x, integral) + np.maximum(x + half - reach, 0.0)
        below = (ahead - np.interp(x - half, x, integral)) / (2.0 * half)
    out = 0.5 * (1.0 - share)
    return middle + float(np.interp(out, below, x)), middle + float(np.interp(1.0 - out, below, x))
