"""Derivatives of a result by the continuous keys of its scene.

A derivative is the central difference of neighbouring solutions at p - h and p + h, each begun at the solution itself.  With
h = 1e-4 p its error is h^2 / 6 of the third derivative, 1e-8 or less of it, and what iterations leave, 1e-12, over 1e-4.  Where
differences are less even than such a step explains, a smaller one is taken; where none is, a contact opens or closes there, or the
model has a kink.

Of rigid bodies all neighbours are columns of one build and are solved in compiled loops (``raceway.bodies.columns``).  Other bodies,
laws and keys have a model for each neighbour, equilibrium and steady orbit solved from those of the scene: two, or four with wider
steps where building one solves for a preload or for loads of contacts and leaves its tolerance in them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from typing import TypeAlias

import attrs
import numpy as np

from raceway.bodies.columns import Builder, solved_columns
from raceway.bodies.model import Equilibrium, Model, model_of
from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.search import PeriodicMotion, problem_of
from raceway.core.periodic.steady import find, growth_of_disturbances, refuse, synchronous_response
from raceway.core.record import Schedule
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.system import surrogate
from raceway.core.signals import impedance
from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.contracts import SolvedPoints
from raceway.framework.duties import fitting_quantities, renews
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.quantities import solved_point, stated_numbers
from raceway.planning.columns import why_no_column, why_not
from raceway.planning.resolve import Problem, resolve
from raceway.scene.keys import Key, key_of, with_number, with_numbers

#: Weights of values at shifts by so many steps: their sum over the step is the derivative, of second and of fourth order.
SECOND_ORDER = {1: 1.0 / 2.0}
FOURTH_ORDER = {1: 8.0 / 12.0, 2: -1.0 / 12.0}
#: Steps over the number, of the two orders; what a step is divided by where differences are uneven, down to the least.
_STEP, _WIDE, _SMALLER, _LEAST_STEP = 1e-4, 5e-4, 10.0, 2e-6
#: Least steps by unit, unless that is more than a part of the number.
_LEAST = {"m": 1e-9, "N": 0.02, "N m": 1e-4, "deg": 1e-3, "r/min": 1.0, "K": 1e-3, "kg": 1e-4, "s": 1e-9, "N s/m": 0.01}
_ELSE, _PART = 1e-7, 1e-3
#: Second difference over the first that calls for a smaller step, and that is a kink; rounding of a stiffness.
_UNEVEN, _KINK, _ROUNDING = 5e-4, 0.02, 1e-11
_BENDS = "one-sided derivatives differ at this value"
_AT_THE_EDGE = "a contact opens or closes near this value: derivatives beyond it differ"
#: Arrays of a system that forces at rest and in motion depend on.
_ARRAYS = ("scalars", "table", "stiffness", "load", "law_params", "mass", "damping", "force_params")
#: Samples of a turn with which the force's period is checked; tolerance of the orbit where the scene's integrator has none, and of
#: neighbouring ones; difference of Z of the same orbit in a compiled loop.
_SAMPLES, _TOLERANCE, _SOLVED, _SAME = 360, 1e-8, 1e-12, 1e-6

#: Of m solutions: displacement (m, 5), stiffness and damping (m, 5, 5), contact_force (m, 2 Z), and in motion line (m, 5).
_Solutions: TypeAlias = dict[str, np.ndarray]


class NoDerivative(Exception):  # noqa: N818  (an answer, stated in the table, no failure)
    """Why a quantity has no derivative by a key, in one sentence."""


@attrs.frozen(eq=False)
class StaticGradient:
    """Derivatives of an equilibrium by the number at one key."""

    key: Key
    step: float  # of the differences, in the unit of the key; 0 where it changes nothing at rest
    displacement: np.ndarray  # (5,) [m, rad]
    stiffness: np.ndarray  # (5, 5) of the contacts
    damping: np.ndarray  # (5, 5)
    contact_force: np.ndarray  # (2 Z,) inner races first [N]
    stated: np.ndarray  # of ``Gradients.stated``
    remark: str  # why they may not be smooth; empty where they are
    models: int  # that were built for them, beside columns


@attrs.frozen(eq=False)
class _MotionGradient:
    """Derivatives of the 1x line of the steady orbit by the number at one key."""

    dynamic_stiffness: complex  # of Z [N/m]
    equivalent_stiffness: float  # of K [N/m]
    equivalent_damping: float  # of C [N s/m]
    amplitude: float  # of the 1x line along the force [m]


@attrs.frozen(eq=False)
class Gradient:
    """Derivatives by one key: of the equilibrium, and of the steady orbit where the scene has an excitation."""

    statics: StaticGradient
    motion: _MotionGradient | None

    @property
    def nothing(self) -> bool:
        """Whether the key changes nothing at all."""
        return self.statics.step == 0.0 and (self.motion is None or not any(attrs.astuple(self.motion)))


@attrs.define(eq=False)
class SteadyOrbit:
    """The steady orbit of a model under its excitation that is taken, with others beside it."""

    model: Model
    orbit: PeriodicMotion

    @property
    def solved(self) -> Solved:
        return self.orbit.refined.solved

    @classmethod
    def of(cls, model: Model, equilibrium: Equilibrium) -> "SteadyOrbit":
        """Search for it.

        SceneError: An excitation or bodies that have no steady orbit of the force's period.
        ConvergenceError: None was found.
        """
        period = model.excitation.period_s
        if period is None:
            why = "a force whose speed changes has no steady orbit: use 'unidirectional' or 'bidirectional'"
            raise SceneError.at("excitation.kind", model.excitation.name, why)
        refuse(model.system, Schedule(period / _SAMPLES, _SAMPLES, 1))
        system = surrogate(model.system)
        q = equilibrium.displacement
        problem = problem_of(system, 2.0 * np.pi / period, q)
        if system.scalars[CAGE] != 0.0 and not problem.symmetry.pitch:
            why = "the ball-pass frequency of orbiting balls differs from that of the force: no motion repeats every turn"
            raise SceneError.at("kinematics.orbiting", True, why)
        tolerance = float(getattr(model.problem.integrator.method, "tolerance", _TOLERANCE))
        return cls(model, find(problem, q, equilibrium.stiffness_rows_held, min(tolerance, _TOLERANCE)))

    @property
    def warning(self) -> str:
        """What a person must know of an orbit that is unstable; empty where it is not."""
        if self.orbit.floquet.verdict != "unstable":
            return ""
        return f"the steady orbit is unstable, {growth_of_disturbances(self.orbit.floquet)}: the ring leaves it, and its derivatives belong to no lasting motion"

    @cached_property
    def line(self) -> np.ndarray:
        """(5,) Re Z, C and K [N/m, N s/m, N/m], amplitude [m], Im Z [N/m]."""
        return _line_numbers(self.solved, self.model.mass_used)

    def near(self, model: Model, shift: np.ndarray) -> np.ndarray:
        """The same of a neighbouring model, whose equilibrium is moved by (5,)."""
        speed, path = 2.0 * np.pi / float(model.excitation.period_s), self.solved.path
        problem = attrs.evolve(self.solved.problem, system=surrogate(model.system), speed=speed, clock=speed)
        return _line_numbers(solve(problem, attrs.evolve(path, q=path.q + shift), _SOLVED), model.mass_used)


def _line_numbers(solution: Solved, mass: float) -> np.ndarray:
    z, amplitude = synchronous_response(solution)
    omega = solution.problem.speed
    return np.array([z.real, z.imag / omega, z.real + mass * omega**2, amplitude, z.imag])


@attrs.frozen(eq=False)
class Gradients:
    """Derivatives of an equilibrium, and of the steady orbit about it.

    SceneError: Bodies whose contacts are pressures at surface points, or are not compiled.
    """

    model: Model
    equilibrium: Equilibrium
    moving: bool = True  # False leaves the orbit out

    def __attrs_post_init__(self) -> None:
        refuse_points(self.model.problem)

    @cached_property
    def orbit(self) -> SteadyOrbit | None:
        """The steady orbit, searched for once, None in a static scene; SceneError, ConvergenceError: none, or none found."""
        has_orbit = self.moving and self.model.excitation is not None
        return SteadyOrbit.of(self.model, self.equilibrium) if has_orbit else None

    @cached_property
    def _plugins(self) -> list[str]:
        """Plug-ins of quantities whose numbers ``stated`` has."""
        fitting = [] if self.model.excitation is not None else fitting_quantities(self.model.problem)
        return [plugin.name for plugin in fitting]

    @cached_property
    def stated(self) -> dict[str, float]:
        """Numbers of plug-ins, of scenes without a motion."""
        numbers = stated_numbers(solved_point(self.model, self.equilibrium, None), self._plugins)
        return {name: float(value[0]) for name, value in numbers.items() if np.isfinite(value[0])}

    def by_path(self, path: str) -> Gradient:
        """By the key of a path, such as "load.axial"; SceneError: no continuous key, or one without a derivative."""
        answer = self.by_all([key_of(self.model.scene, path)])[0]
        if isinstance(answer, NoDerivative):
            raise SceneError.at(path, None, str(answer))
        return answer

    def by_all(
        self, keys: Sequence[Key], on_progress: Callable[[str, int, int], None] | None = None
    ) -> list[Gradient | NoDerivative]:
        """By several keys; of those that have no derivative, why.

        on_progress : called as ``on_progress(what, done, total)``
        """
        answers: dict[str, Gradient | NoDerivative] = dict(self._ends(keys))
        scene, problem = self.model.scene, self.model.problem
        alone = self.model.traits.contacts_alone and not why_not(problem, False)
        if alone and not (self.orbit and scene.kinematics.orbiting):
            answers |= self._by_columns([k for k in keys if k.path not in answers and not why_no_column(problem, k.path)])
        for count, key in enumerate(keys):
            if on_progress is not None:
                on_progress("keys", count, len(keys))
            if key.path not in answers:
                try:
                    answers[key.path] = self._by_models(key)
                except NoDerivative as why:
                    answers[key.path] = why
        return [answers[key.path] for key in keys]

    def _ends(self, keys: Sequence[Key]) -> dict[str, NoDerivative]:
        """Keys at the end of their range, whatever they do."""

        def refusal(keys: Iterable[Key], side: float) -> str:
            numbers = {key.path: key.value + side * _difference_step(key, _WIDE) for key in keys}
            try:
                with_numbers(self.model.scene, numbers)
            except ValueError as why:
                return str(why)
            return ""

        def ends(keys: list[Key], side: float) -> dict[str, str]:
            """By halves: several at once take as long as one, and few are refused."""
            why, half = refusal(keys, side), len(keys) // 2
            if not why or half == 0:
                return {key.path: why for key in keys if why}
            return ends(keys[:half], side) | ends(keys[half:], side)

        why = {key.path: refusal([key], -1.0) for key in keys if key.value == 0.0}
        inside = [key for key in keys if not why.get(key.path)]
        why |= ends(inside, 1.0) | ends(inside, -1.0)
        zero = "is 0, the end of its range: it switches a part of the model on"
        at_end = {key: f"is at the end of its range: {why[key.path]}" for key in keys if why.get(key.path)}
        return {key.path: NoDerivative(words if key.value else zero) for key, words in at_end.items()}

    def _by_columns(self, keys: Sequence[Key], relative: float = _STEP) -> dict[str, Gradient]:
        """Of keys whose neighbours are solved in compiled loops."""
        if not keys:
            return {}
        scene, q, steps = self.model.scene, self.equilibrium.displacement, [_difference_step(key, relative) for key in keys]
        columns = {key.path: np.full(1 + 2 * len(keys), key.value) for key in keys}
        for k, (key, step) in enumerate(zip(keys, steps, strict=True)):
            columns[key.path][1 + 2 * k : 3 + 2 * k] += -step, step
        runaway = np.zeros(1 + 2 * len(keys), dtype=bool)
        if scene.heat is not None:
            from raceway.pipeline.warm import warm

            warmth = warm(scene, columns, self.model.plan)
            columns, runaway = {**columns, **warmth.columns}, warmth.runaway
        bearing = Builder(self.model.plan).at(columns)
        bearing.points.guess[:] = q
        states = bearing.equilibria(damped=True)
        values = {"displacement": states.q, "stiffness": states.stiffness, "contact_force": states.force}
        values["damping"], fine = states.damping, (states.status == 0) & ~runaway
        values["stated"] = self._stated(solved_columns(bearing, states), len(fine))
        if self.orbit is not None:
            orbits = bearing.orbits(states, _TOLERANCE, near=True)
            line, force, w = orbits.line, orbits.force, bearing.force[1]
            line, force = (part[:, :3] + 1j * part[:, 5:8] for part in (line, force))
            z, forward = impedance(force, line), [0.5 * np.abs(line[:, 1] + sign * line[:, 2]) for sign in (1j, -1j)]
            mass = bearing.problem.inertia.mass if self.model.mass_used else 0.0
            values["line"] = np.stack([z.real, z.imag / w, z.real + mass * w**2, sum(forward), z.imag], axis=1)
            fine &= orbits.status == 0
            expected = self.orbit.line
            fine[0] &= abs(z[0] - complex(expected[0], expected[4])) <= _SAME * abs(z[0])
        usable = [k for k in range(len(keys)) if fine[0] and fine[1 + 2 * k] and fine[2 + 2 * k]]
        if not usable:
            return {}
        sides = {side: {k: value[offset::2][usable] for k, value in values.items()} for side, offset in ((-1, 1), (1, 2))}
        base = {name: value[0] for name, value in values.items()}
        answers, uneven = _gradients([keys[k] for k in usable], np.array(steps)[usable], sides, base)
        if uneven and relative > _LEAST_STEP:
            answers |= self._by_columns(uneven, relative / _SMALLER)
        return answers

    def _by_models(self, key: Key, relative: float = _STEP) -> Gradient:
        """Of a key whose neighbours are models of their own; NoDerivative with the reason where there is none."""
        if self.model.scene.heat is not None:
            remedy = "Sample it: raceway band --samples"
            raise NoDerivative(f"also changes the steady temperatures, which derivatives do not solve for. {remedy}")
        wide = self.model.problem.bearing.preloaded or renews(self.model.problem.contact.law)
        step, shifts = _difference_step(key, _WIDE if wide else relative), (-2, -1, 1, 2) if wide else (-1, 1)
        base, ahead = self._values(self.model, self.equilibrium), self._model(key, step)
        solutions, systems = dict.fromkeys(shifts, base), (surrogate(self.model.system), surrogate(ahead.system))
        arrays = [tuple(getattr(system, name) for system in systems) for name in _ARRAYS]
        if any(value.shape != other.shape for value, other in arrays):
            raise NoDerivative("switches a part of the model on or off")
        periods = [None if each.excitation is None else each.excitation.period_s for each in (self.model, ahead)]
        arrays.append((self.model.guess, ahead.guess))
        # Whether anything of the contacts differs, to the last bit.
        moves = periods[0] != periods[1] or not all(np.array_equal(value, other) for value, other in arrays)
        if moves or self.stated:
            models = {k: ahead if k == 1 else self._model(key, k * step) for k in shifts}
            solve = self._solution if moves else partial(self._values, equilibrium=self.equilibrium)
            try:
                solutions = {k: solve(neighbour) for k, neighbour in models.items()}
            except ConvergenceError as why:
                raise NoDerivative(f"the neighbouring states have no balance: {why}") from None
        columns = {k: {name: value[None] for name, value in solution.items()} for k, solution in solutions.items()}
        answers, uneven = _gradients([key], np.array([step]), columns, base, len(shifts))
        if uneven and not wide and relative > _LEAST_STEP:
            return self._by_models(key, relative / _SMALLER)
        return answers[key.path]

    def _model(self, key: Key, by: float) -> Model:
        model = self.model
        problem = resolve(with_number(model.scene, key.path, key.value + by))
        if why := other_meshes(model.problem, problem):
            raise NoDerivative(why)
        try:
            return model_of(problem, model.plan)
        except RacewayError as why:
            raise NoDerivative(f"no model can be built at {key.value + by:.6g}: {why}") from None

    def _solution(self, model: Model) -> _Solutions:
        q = self.equilibrium.displacement
        equilibrium = solve_equilibrium(model, near=q)
        line = None if self.orbit is None else self.orbit.near(model, equilibrium.displacement - q)
        return self._values(model, equilibrium, line)

    def _stated(self, points: SolvedPoints, n: int) -> np.ndarray:
        """(n, numbers) of ``stated``."""
        numbers = stated_numbers(points, self._plugins)
        return np.stack([np.zeros(n), *(numbers[name] for name in self.stated)], axis=1)[:, 1:]

    def _values(self, model: Model, equilibrium: Equilibrium, line: np.ndarray | None = None) -> _Solutions:
        values = {name: getattr(equilibrium, name) for name in ("displacement", "stiffness", "damping", "contact_force")}
        values["stated"] = self._stated(solved_point(model, equilibrium, None), 1)[0]
        if self.orbit is not None:
            values["line"] = self.orbit.line if line is None else line
        return values


def refuse_points(problem: Problem) -> None:
    """Raise ``SceneError`` for bodies whose contacts are pressures at surface points, or are not compiled."""
    if not (problem.traits.compiled and problem.traits.resultants):
        why = "surface points open and close one by one: their forces have no derivative. Use contact.discretisation = 'resultant'"
        raise SceneError.at("bodies.kind", problem.bodies.name, f"{why} on rigid or condensed bodies")


def other_meshes(problem: Problem, other: Problem) -> str:
    """Why a changed problem gives no derivative: its bodies have other meshes; empty where they have the same."""
    if problem.body_kind.same_bodies(other):
        return ""
    return "changes the meshes of the bodies: the difference of two meshes is their error, no derivative. bodies.kind = 'rigid' has one"


def _difference_step(key: Key, relative: float) -> float:
    """Of differences, in the unit of the key."""
    size, least = abs(key.value), _LEAST.get(key.unit, _ELSE) * relative / _STEP
    if ".conformity_" in key.path:  # acts by what it is above one half
        size = 2.0 * abs(size - 0.5)
    return max(relative * size, min(least, _PART * size)) if size else least


def _gradients(
    keys: Sequence[Key], steps: np.ndarray, solutions: Mapping[int, _Solutions], base: _Solutions, models: int = 0
) -> tuple[dict[str, Gradient], list[Key]]:
    """By m keys from solutions at shifts by steps (m,), and keys whose differences are uneven; ``base``: the solution between."""
    slopes = {}
    for name in base:
        # In pairs, so that what does not change gives exactly nothing.
        weights = FOURTH_ORDER if 2 in solutions else SECOND_ORDER
        pairs = [weight * (solutions[k][name] - solutions[-k][name]) for k, weight in weights.items()]
        slopes[name] = (np.sum(pairs, axis=0).T / steps).T
    bends = largest = unevenness([solutions[k]["stiffness"] for k in (-1, 1)], base["stiffness"])
    if "line" in base:  # Z
        largest = np.maximum(bends, unevenness([solutions[k]["line"][:, ::4] for k in (-1, 1)], base["line"][::4]))
    has_load = base["contact_force"] > 0.0
    edges = np.any([((solution["contact_force"] > 0.0) != has_load).any(axis=1) for solution in solutions.values()], axis=0)
    answers, uneven = {}, []
    for k, key in enumerate(keys):
        line, statics = None, {name: slope[k] for name, slope in slopes.items()}
        if "line" in statics:
            real, damping, stiffness, amplitude, imag = statics.pop("line").tolist()
            line = _MotionGradient(complex(real, imag), stiffness, damping, amplitude)
        remark = _AT_THE_EDGE if edges[k] else _BENDS if bends[k] > _KINK else ""
        step = float(steps[k]) if any(slope.any() for name, slope in statics.items() if name != "stated") else 0.0
        at_rest = StaticGradient(key, step, remark=remark if step else "", models=models, **statics)
        answers[key.path] = Gradient(at_rest, line)
        if edges[k] or largest[k] > _UNEVEN:
            uneven.append(key)
    return answers, uneven


def unevenness(sides: Sequence[np.ndarray], middle: np.ndarray) -> np.ndarray:
    """(m,) second difference over the first, of values (m, ...) before and after those in the middle; 0 of a turning point."""
    before, after = (side.reshape(len(side), -1) for side in sides)
    first = np.abs(after - before).max(axis=1)
    second = np.abs(after + before - 2.0 * middle.ravel()).max(axis=1) - _ROUNDING * np.abs(middle).max()
    return np.where(first > 0.1 * second, np.maximum(second, 0.0) / np.maximum(first, 1e-300), 0.0)
