"""Derivatives of the dynamic stiffness of a steady orbit by a continuous key.

Notes
-----
The collocated orbit u solves R(u, p) = 0 with the exact tangent that Newton's iteration and branches use.  Its derivative is one
linear problem, du/dp = -R_u^-1 dR/dp round the span, dR/dp at the fixed orbit along the derivatives of the model's arrays; the 1x line
is then differentiated along u + h du/dp, p + h.  With dashpots the rates of the balls follow the orbit, and tangents lack how
their forces turn with the contacts: what is left of dR/dp along the line is then taken off again, until the derivative stays.
"""

from __future__ import annotations

from functools import cached_property

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.periodic.arrays import Change
from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.direct import problem_of
from raceway.core.periodic.intervals import condense, imbalances
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.rates import renew, stiff
from raceway.core.periodic.search import Found, find
from raceway.core.periodic.steady import refuse
from raceway.core.periodic.sweep import spread
from raceway.core.periodic.told import first_line, orbits, unstable
from raceway.core.ring.address import by_address
from raceway.core.ring.kernels.layout import CAGE, DAMPING, TIME_CONSTANT
from raceway.core.ring.surrogate import surrogate
from raceway.core.ring.system import System
from raceway.core.stepping.record import Schedule
from raceway.errors import ConvergenceError, SceneError
from raceway.pipeline.gradient.statics import StaticGradient
from raceway.pipeline.gradient.variation import Direction, NoDerivative

#: Samples of a turn with which the force's period is checked; tolerance of the orbit where the scene's integrator has none.
_SAMPLES, _TOLERANCE = 360, 1e-8
#: Largest step over the number at the key, and over the step of the static differences: errors fall with its square.
_LARGEST, _SHARE = 3e-5, 0.03
#: Turns of orbit and rates; what the last one still changes, over the whole: the next one is a tenth of it or less; rounding of
#: a motion over its size.
_RATES, _LEFT, _ROUNDING = 12, 1e-7, 1e-11


@attrs.frozen(eq=False)
class MotionGradient:
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
    found : the orbit that is taken, with others beside it
    """

    model: Model
    found: Found

    @property
    def solved(self) -> Solved:
        return self.found.refined.solved

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
        tolerance = float(getattr(model.scene.integrator.method, "tolerance", _TOLERANCE))
        return cls(model, find(problem, q, equilibrium.stiffness_rows_held, min(tolerance, _TOLERANCE)))

    @property
    def warning(self) -> str:
        """What a person must know of an orbit that is unstable; empty where it is not."""
        told = orbits([self.found])[0]
        if told["stable"]:
            return ""
        return f"the steady orbit is unstable, {unstable(told)}: a ring leaves it, and what holds of it holds of no lasting motion"

    @cached_property
    def line(self) -> np.ndarray:
        """(4,) Re Z, C and K [N/m, N s/m, N/m], amplitude [m]."""
        return _line(self.solved, self.model.mass_used)

    def gradient(self, statics: StaticGradient) -> MotionGradient:
        """By the key of a static gradient, with whose displacement coordinates that are held move.

        Raises
        ------
        NoDerivative
            There is none, with the reason.
        """
        direction = statics.direction
        step = _LARGEST * abs(statics.key.value) or direction.tried
        if statics.step:
            step = min(step, _SHARE * statics.step)
        try:
            real, damping, stiffness, amplitude, speed = self._differentiated(direction, step, statics.displacement)
        except ConvergenceError as why:
            raise NoDerivative(f"the neighbouring orbits have no balance: {why}") from None
        omega = self.solved.problem.speed
        imag = damping * omega + self.line[1] * speed
        return MotionGradient(complex(real, imag), float(stiffness), float(damping), float(amplitude))

    def _differentiated(self, direction: Direction, step: float, displacement: np.ndarray) -> np.ndarray:
        """(5,) derivatives of ``line`` and of the speed."""
        problems = {k: self._problem(direction, k * step) for k in (-1, 1)}
        solved, held = self.solved, np.where(self.model.system.free > 0.0, 0.0, displacement)
        rates = {k: solved.path.rate * (one.speed / solved.problem.speed) for k, one in problems.items()}
        lagging = any(solved.problem.system.scalars[entry] != 0.0 for entry in (DAMPING, TIME_CONSTANT))
        faster = (problems[1].speed - problems[-1].speed) / (2.0 * step)
        path, first = solved.path, 0.0
        rounding = _ROUNDING * np.abs(path.a / solved.problem.weight).max() / step
        moved = {k: attrs.evolve(path, q=path.q + k * step * held, rate=rates[k]) for k in problems}
        for turn in range(_RATES):
            slope = (_imbalance(problems[1], moved[1]) - _imbalance(problems[-1], moved[-1])) / (2.0 * step)
            if turn == 0 and not slope.any() and not held.any() and faster == 0.0:
                return np.zeros(5)
            change = self._change(slope)
            moved = {k: _moved(one, change, k * step) for k, one in moved.items()}
            size = float(np.abs(change.a / solved.problem.weight).max())
            first = first or size
            if not lagging or turn > 0 and size <= max(_LEFT * first, rounding):
                break
            moved = {k: attrs.evolve(one, rate=_rates(problems[k], one)) for k, one in moved.items()}
        lines = {
            k: _line(attrs.evolve(solved, problem=problems[k], path=one), self._mass(problems[k].system))
            for k, one in moved.items()
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
        out, report = problem.eliminated(path.nodes), np.zeros(3)
        samples = attrs.evolve(path, ball=path.ball.copy()).samples(problem.push(path.nodes), slope)
        if condense(problem.equations, problem.mesh(path.nodes), samples, out, report) < path.intervals:
            raise ConvergenceError("the balls find no place between the races")
        # What is left of the balance of forces is no part of the derivative.
        out.stages[:, 2 * n] = out.transfer[:, 2 * n] = 0.0
        first = np.linalg.solve(problem.closing - out.whole[:, : 2 * n], out.whole[:, 2 * n + 1])
        change = Change(np.zeros_like(path.q), np.zeros_like(path.v), np.zeros_like(path.a))
        spread(problem.free, out, first, 1.0, change)
        return change


def _imbalance(problem: Problem, path: Path) -> np.ndarray:
    push = problem.push(path.nodes)
    out = np.zeros_like(push)
    if imbalances(problem.equations, problem.mesh(path.nodes), path.samples(push), out) < path.intervals:
        raise ConvergenceError("the balls find no place between the races")
    return out


def _moved(path: Path, change: Change, by: float) -> Path:
    return attrs.evolve(path, q=path.q + by * change.q, v=path.v + by * change.v, a=path.a + by * change.a)


def _rates(problem: Problem, path: Path) -> np.ndarray:
    """Rates of the balls along a path."""
    there = attrs.evolve(path, ball=path.ball.copy(), rate=path.rate.copy())
    out, report = problem.eliminated(path.nodes), np.zeros(3)
    if (
        condense(problem.equations, problem.mesh(path.nodes), there.samples(problem.push(path.nodes)), out, report)
        < path.intervals
    ):
        raise ConvergenceError("the balls find no place between the races")
    renew(problem, there, stiff(problem, there))
    return there.rate


def _line(solved: Solved, mass: float) -> np.ndarray:
    z, amplitude = first_line(solved)
    omega = solved.problem.speed
    return np.array([z.real, z.imag / omega, z.real + mass * omega**2, amplitude])
