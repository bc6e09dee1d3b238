"""Small mechanical systems with known motions, and the compiled loops of the suites, which call kernels as the time loops do:
by function pointers.

The mass moves along x against one contact (gap = clearance - x, the contact pushes along -x) and along y and z on linear
springs, which a gyroscopic term couples.  Balls and tilts do not move.  A bearing has two races, so there are two
contacts; the second one stays open.
"""

from collections.abc import Callable
from importlib import import_module

import attrs
import numpy as np
from numba import float64, int64, void

from raceway.contact_laws.hertz import three_halves
from raceway.core.jit import jit
from raceway.core.record import Motion
from raceway.core.ring.kernels.impact import CLEARANCE, impact_system
from raceway.core.ring.system import System
from raceway.core.signatures import FORCE, FORCE_POINTER, LAW, LAW_POINTER, MATRIX, VECTOR
from raceway.plugins.excitations.harmonic import harmonic
from raceway.testing.suite import require

#: Gap of contacts that stay open [m].
_OPEN = 1.0
#: Mass [kg], stiffness [N/m], damping and gyroscopic coupling [N s/m] of the springs' motion.
MASS, STIFFNESS, DASHPOT, GYROSCOPIC = 2.0, 2e8, 600.0, 800.0
#: Circular frequency of the springs [rad/s] and the period [s].
NATURAL = float(np.sqrt(STIFFNESS / MASS))
PERIOD = 2.0 * np.pi / NATURAL
#: Factor of the contact [N/m^1.5] and the load [N] that preloads it.
FACTOR, PRELOAD = 1e10, 300.0
#: Amplitude of the force [N] and its speed [rad/s]: three quarters of the natural frequency.
AMPLITUDE, SPEED = 200.0, 0.75 * NATURAL


@jit(void(int64, LAW_POINTER, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, float64, VECTOR, VECTOR, VECTOR))
def repeat_law(count, law, gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Call a law ``count`` times with the same arguments."""
    for _ in range(count):
        law(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate)


@jit(void(LAW_POINTER, MATRIX, MATRIX, MATRIX, float64, MATRIX, MATRIX, MATRIX, MATRIX))
def along_path(law, gaps, rates, params, dt, state_old, state_new, scratch, forces):
    """Drive n contacts along paths (steps, n) of gap and rate; the state is committed after each step.

    ``scratch`` is (2, n); ``forces`` (steps, n) is the answer.
    """
    for step in range(gaps.shape[0]):
        law(gaps[step], rates[step], params, state_old, state_new, dt, forces[step], scratch[0], scratch[1])
        for i in range(state_old.shape[0]):
            for j in range(state_old.shape[1]):
                state_old[i, j] = state_new[i, j]


@jit(void(int64, FORCE_POINTER, VECTOR, VECTOR, MATRIX))
def sample_force(repeats, force, params, times, out):
    """out (n, 5): the force at times (n,); the row of samples is taken ``repeats`` times."""
    for _ in range(repeats):
        for i in range(times.size):
            force(times[i], params, out[i])


@jit(FORCE)
def along_x(t, params, out):
    """Force params[0] cos(params[1] t) along the axis."""
    for i in range(out.size):
        out[i] = 0.0
    out[0] = params[0] * np.cos(params[1] * t)


@jit(LAW)
def _counting(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz in the first contact; in the second, which is open, the "force" says how often its memory was committed."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        root = params[i, 0] * np.sqrt(approach)
        state_new[i, 0] = state_old[i, 0] + 1.0
        force[i] = root * approach if i == 0 else state_new[i, 0]
        d_gap[i] = -1.5 * root
        d_rate[i] = 0.0


def require_no_allocation(call: Callable[[int], object]) -> None:
    """Compiled code that ``call(n)`` runs n times takes no block of memory.

    Statistics of numba's own runtime are the only trace of such allocations; its switch is put back.
    """
    runtime = import_module("numba.core.runtime")
    runtime.rtsys.initialize(import_module("numba.core.registry").cpu_target.target_context)
    counters, blocks = runtime._nrt_python, []
    was_on = counters.memsys_stats_enabled()
    counters.memsys_enable_stats()
    for count in (1, 1001):
        before = int(counters.memsys_get_stats_alloc())
        call(count)
        blocks.append(int(counters.memsys_get_stats_alloc()) - before)
    if not was_on:
        counters.memsys_disable_stats()
    require(blocks[1] == blocks[0], f"a call allocates {(blocks[1] - blocks[0]) / 1000:g} blocks of memory")


def counting_system() -> System:
    """``contact_system`` with the law ``_counting``."""
    return attrs.evolve(contact_system(), law=_counting, law_state=np.zeros((2, 1)))


def _system(free: list[float], clearance: float = 0.0, **parts: object) -> System:
    system = impact_system(MASS, three_halves(), np.array([FACTOR]), clearance=clearance)
    return attrs.evolve(system, free=np.array(free), **parts)


def linear_system(damped: bool = True, forced: bool = True) -> System:
    """Springs along y and z, coupled by a gyroscopic term, under a force that turns forward; the contact stays open."""
    damping = np.zeros((5, 5))
    if damped:
        damping[1:3, 1:3] = [[DASHPOT, GYROSCOPIC], [-GYROSCOPIC, DASHPOT]]
    force = {"force": harmonic(), "force_params": np.array([AMPLITUDE, SPEED, 0.3, 1.0, 0.0, 0.0, 1.0])} if forced else {}
    stiffness = np.diag([0.0, STIFFNESS, 1.3 * STIFFNESS, 0.0, 0.0])
    return _system([0.0, 1.0, 1.0, 0.0, 0.0], damping=damping, stiffness=stiffness, clearance=_OPEN, **force)


def contact_system(load: float = PRELOAD, clearance: float = 0.0) -> System:
    """A mass on a Hertzian contact, pressed on by a constant load along x."""
    return _system([1.0, 0.0, 0.0, 0.0, 0.0], load=np.array([load, 0.0, 0.0, 0.0, 0.0]), clearance=clearance)


def motion(system: System, q: np.ndarray, v: np.ndarray) -> Motion:
    """A consistent start: the acceleration balances the forces at time zero."""
    still = np.zeros((1, 2))
    outer = system.outer_force(0.0)
    return Motion(q, v, system.acceleration(q, v, outer, system.evaluate(q, v, ball=still)), still, still.copy())


def exact(system: System, start: Motion, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and velocity (n, 5) by an eighth-order method at tolerances near rounding."""
    from scipy.integrate import solve_ivp

    free = system.free > 0.0

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        q, v = np.ascontiguousarray(state[:5]), np.ascontiguousarray(state[5:])
        now = system.evaluate(q, v, ball=np.zeros((1, 2)))
        return np.concatenate([v * free, system.acceleration(q, v, system.outer_force(t), now)])

    scale = np.concatenate([np.full(5, 1e-6), np.full(5, 1e-6 * NATURAL)])
    # 1e-12 of the motion: far below the errors of the steps that are compared with it.
    state = np.concatenate([start.q, start.v])
    solution = solve_ivp(slope, (0.0, times[-1]), state, "DOP853", times, rtol=1e-11, atol=1e-11 * scale)
    return solution.y[:5].T, solution.y[5:].T


def contact_energy(system: System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n,) kinetic and stored energy less the work of the load [J], for the springs and the Hertzian contact."""
    approach = np.maximum(q[:, 0] - system.scalars[CLEARANCE], 0.0)
    springs = 0.5 * np.einsum("ni,ij,nj->n", q, system.stiffness, q) - q @ system.load
    return 0.5 * np.einsum("ni,ij,nj->n", v, system.mass, v) + springs + 0.4 * system.law_params[0, 0] * approach**2.5
