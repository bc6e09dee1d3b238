"""Oscillators of one degree of freedom with closed forms, as systems that the code for bearings solves.

The mass moves along x against one contact of the law below, which acts to both sides: the force is a K |x|^n with the sign
of x, beside a linear spring and a dashpot, under F cos(w t).
"""

import math

import attrs
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from scipy.special import beta

from raceway import LAW, jit
from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.turn import one_turn
from raceway.extend import System
from raceway.testing.systems import along_x, contact_system


@jit(LAW)
def odd_power(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):  # type: ignore[no-untyped-def]
    """force = params[0] |x|^params[1] with the sign of x = -gap, of the first contact; nothing of the others."""
    for i in range(gap.size):
        force[i], d_gap[i], d_rate[i] = 0.0, 0.0, 0.0
    x = -gap[0]
    size = abs(x)
    force[0] = params[0, 0] * size ** params[0, 1] * (1.0 if x >= 0.0 else -1.0)
    d_gap[0] = -params[0, 0] * params[0, 1] * size ** (params[0, 1] - 1.0)


@attrs.frozen
class Oscillator:
    """m x'' + c x' + k x + b |x|^n sign(x) = F cos(w t)."""

    mass: float = 1.0
    damping: float = 0.0
    stiffness: float = 1.0
    factor: float = 0.0
    exponent: float = 3.0
    force: float = 0.0

    def system(self, speed: float) -> System:
        """As the compiled loops take it, under its force with w [rad/s]."""
        one = np.zeros((5, 5))
        one[0, 0] = 1.0
        return attrs.evolve(
            contact_system(0.0), law=odd_power, law_params=np.full((2, 2), [self.factor, self.exponent]), mass=self.mass * np.eye(5),
            damping=self.damping * one, stiffness=self.stiffness * one, force=along_x, force_params=np.array([self.force, speed]),
        )  # fmt: skip

    def problem(self, speed: float, turns: int = 1) -> Problem:
        system = self.system(speed)
        symmetry = one_turn(system)
        return Problem(system, speed, attrs.evolve(symmetry, span=turns * symmetry.span))

    def orbit(self, speed: float, amplitude: complex, intervals: int = 40) -> Solved:
        """The orbit near Re(amplitude e^{j w t})."""
        problem = self.problem(speed)
        nodes = np.linspace(0.0, 2.0 * np.pi, intervals + 1)

        def along(angles: np.ndarray, derivative: int) -> np.ndarray:
            out = np.zeros((len(angles), 5))
            out[:, 0] = (amplitude * 1j**derivative * np.exp(1j * angles)).real
            return out

        inner = problem.angles(nodes)
        shape = (len(inner), 1, problem.system.ball_columns)
        path = Path(nodes, along(nodes, 0), along(nodes, 1), along(inner, 2), np.zeros(shape), np.zeros(shape))
        return solve(problem, path, 1e-12)

    def folds(self, guesses: list[tuple[float, float]]) -> np.ndarray:
        """(n, 2) w and amplitude of the folds of a weak cubic spring, by its first harmonic alone, from first guesses.

        With s = 3/4 b A^2 and u = k - m w^2: ((u + s)^2 + c^2 w^2) A^2 = F^2, and a fold where (u + s)(u + 3 s) + c^2 w^2 = 0
        (Nayfeh, Mook, Nonlinear Oscillations (1979), section 4.1).  The third harmonic changes w by (b A^2 / k)^2 3/128 of it.
        """

        def zero(given: np.ndarray) -> list[float]:
            w, a = given
            s, u, d = 0.75 * self.factor * a**2, self.stiffness - self.mass * w**2, (self.damping * w) ** 2
            return [((u + s) ** 2 + d) * a**2 / self.force**2 - 1.0, ((u + s) * (u + 3.0 * s) + d) / d]

        return np.array([fsolve(zero, guess, xtol=1e-14) for guess in guesses])


def natural_frequency(factor: float, exponent: float, mass: float, amplitude: np.ndarray) -> np.ndarray:
    """w (n,) [rad/s] of a free mass on b |x|^n at amplitudes (n,): by the energy, exact.

    A quarter of a period is the integral of dx / v with m v^2 / 2 = b (A^(n+1) - x^(n+1)) / (n + 1):
    T = 4 sqrt(m (n + 1) / (2 b)) A^((1 - n)/2) B(1/(n + 1), 1/2) / (n + 1).  For n = 3/2: w ~ A^(1/4).
    """
    n = exponent
    root = np.sqrt(mass * (n + 1.0) / (2.0 * factor))
    period = 4.0 * root * amplitude ** (0.5 * (1.0 - n)) * beta(1.0 / (n + 1.0), 0.5) / (n + 1.0)
    return np.asarray(2.0 * np.pi / period)


@attrs.frozen
class Pressed:
    """A mass pressed on a Hertzian contact: m x'' + c x' + b max(x, 0)^1.5 = P (1 + part cos(w t)), b = 1, m = 1, P = 1.

    damping : ratio to critical damping of small vibrations;  part : amplitude of the force over the load
    """

    damping: float = 0.005
    part: float = 0.4

    @property
    def natural(self) -> float:
        """w of small vibrations about x = 1: m w^2 = 3/2."""
        return float(np.sqrt(1.5))

    def problem(self, ratio: float) -> Problem:
        """Under a force at ``ratio`` times the natural frequency."""
        one, w = np.zeros((5, 5)), ratio * self.natural
        one[0, 0] = 2.0 * self.damping * self.natural
        system = attrs.evolve(
            contact_system(1.0), law_params=np.full((2, 1), 1.0), mass=np.eye(5), damping=one, force=along_x,
            force_params=np.array([self.part, w]),
        )  # fmt: skip
        return Problem(system, w, one_turn(system))

    def section(self, ratio: float, first: tuple[float, float], turns: int) -> np.ndarray:
        """(turns + 1, 2) x and x' once a turn, by DOP853, from a state at the force's maximum."""
        w, c, part = ratio * self.natural, 2.0 * self.damping * self.natural, self.part

        def rate(t: float, state: np.ndarray) -> tuple[float, float]:
            x, v = float(state[0]), float(state[1])
            return v, 1.0 + part * math.cos(w * t) - c * v - (x**1.5 if x > 0.0 else 0.0)

        times = 2.0 * np.pi / w * np.arange(turns + 1)
        return np.asarray(solve_ivp(rate, (0.0, times[-1]), first, "DOP853", times, rtol=1e-9, atol=1e-11).y.T)
