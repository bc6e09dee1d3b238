"""The motion that a ring settles on where its steady orbit is unstable or none was found: a time integration, and its Poincaré section.

The section holds the state once a turn.  It comes back after m turns: an orbit of m turns.  Else its spectrum decides: components at
multiples of one frequency, modulo one a turn, belong to a quasi-periodic motion, whose section is a closed curve; what else does
not repeat is chaotic, or has not settled in the turns that were integrated.

Nayfeh, Balachandran, Applied Nonlinear Dynamics (1995), sections 4.1 and 4.2.
"""

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.model import build_model
from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.floquet import transfer
from raceway.core.periodic.refinement import states
from raceway.core.periodic.search import highest_order
from raceway.core.record import Motion, Record, Schedule
from raceway.core.ring.kernels.layout import DAMPING
from raceway.core.ring.ring import Ring
from raceway.core.time.schemes import integrate
from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.loading.registry import default_registry
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.result import Result
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

OnProgress = Callable[[str, int, int], None]
#: Steps a turn, and those that are recorded; the step's error moves a settled orbit by some 1e-4.
_STEPS, _RECORDED = 360, 24
#: Explicit steps over their stable limit, up to which they are taken: contacts may become four times as stiff.
_EXPLICIT = 0.5
#: Turns in which the force grows on a ring at rest.
_RAMP = 40
#: Disturbance at the start over the orbit's size, along the disturbance that grows most.
_KICK = 1e-2
#: Turns after which an orbit may come back, and by what it may miss itself over its size.
_PERIODS, _BACK = 8, 1e-4
#: Turns of the section that is judged; harmonics of the second frequency, and the share of the section's power they have.
_JUDGED, _HARMONICS, _POWER = 512, 12, 0.999
#: Relative error to which the orbit of a run is solved for again.
_AGAIN = 1e-9

REPEATS, QUASI, WANDERS, FAILED = "repeats", "quasi-periodic", "does not repeat", "not integrated"


@attrs.frozen(eq=False)
class Attractor:
    """The motion that a time integration ends on.

    Attributes
    ----------
    parameter : value of the key;  kind : REPEATS, QUASI, WANDERS or FAILED;  turns : integrated
    period : turns after which it comes back, of REPEATS;  second : frequency in cycles a turn, of QUASI, at most 1/2
    least, most : smallest and largest half range of the radial displacement in a turn [m]
    why : it was not integrated, of FAILED;  undamped : whether the contacts' dashpots were left out
    section : (n, 2) y [m] and its velocity over w [m], once a turn
    """

    parameter: float
    kind: str
    turns: int
    period: int | None = None
    second: float | None = None
    least: float | None = None
    most: float | None = None
    why: str = ""
    undamped: bool = False
    section: np.ndarray = attrs.field(factory=lambda: np.empty((0, 2)))

    @property
    def words(self) -> str:
        """In a sentence."""
        if self.kind == FAILED:
            return f"not integrated: {self.why}"
        assert self.least is not None and self.most is not None
        half_range = f"half range {1e6 * self.least:.4g} to {1e6 * self.most:.4g} µm a turn"
        if self.undamped:
            half_range += " (without the contacts' dashpots, with which grazing balls have no equilibrium)"
        if self.kind == REPEATS:
            after = "every turn: another orbit" if self.period == 1 else f"after {self.period} turns"
            return f"repeats {after}, {half_range}"
        if self.kind == QUASI:
            return f"quasi-periodic, second frequency {self.second:.5g} a turn of the force, {half_range}"
        return f"does not repeat in {self.turns} turns, {half_range}"

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "section": self.section.tolist(), "words": self.words}


def attractor_beside_run(result: Result, parameter: float, turns: int) -> Attractor:
    """The same of a run by ``integrator.kind`` = "periodic" whose orbit is unstable."""
    assert result.simulation is not None
    solution, equilibrium = result.simulation.whole.solution, result.equilibrium
    problem = solution.problem
    guess = solution.first_guess(problem, equilibrium.displacement, equilibrium.stiffness, solution.excess.nodes)
    try:
        orbit = solve(problem, guess, _AGAIN)
        over = transfer(orbit, highest_order(problem, equilibrium.stiffness))
    except ConvergenceError as why:
        return Attractor(parameter, FAILED, turns, why=str(why))
    return attractor_beside(orbit, over, parameter, turns)


def attractor_from_rest(scene: Scene, parameter: float, turns: int) -> Attractor:
    """From rest under a force that grows within some turns, for ``turns`` turns from then on."""
    model = build_model(scene)
    equilibrium, period = solve_equilibrium(model), scene.excitation.period_s
    schedule = Schedule(period / _STEPS, _STEPS, _RAMP + turns, _STEPS // _RECORDED, _RAMP * period)

    def start(system: Ring) -> Motion:
        return model.bearing.at_rest(system, equilibrium.displacement, equilibrium.ball, True)

    return _end_of(model.system, start, schedule, parameter, turns, None)


def attractor_beside(
    orbit: Solved, over: np.ndarray, parameter: float, turns: int, on_progress: OnProgress | None = None
) -> Attractor:
    """From beside an orbit, along the disturbance that grows most in a transfer ``over`` its span."""
    problem, free = orbit.problem, orbit.problem.free
    w, n = problem.speed, len(free)
    values, vectors = np.linalg.eig(over)
    way = vectors[:, np.argmax(np.abs(values))].real
    way *= _KICK * orbit.size / max(float(np.abs(way / np.tile(problem.weight[free], 2)).max()), 1e-300)
    q, v, _, ball, _ = (part[0] for part in states(orbit, np.zeros(1)))
    q, v = q.copy(), w * v
    q[free] += way[:n]
    v[free] += w * way[n:]

    def start(system: Ring) -> Motion:
        now = system.evaluate(q, v, ball=ball)
        return Motion(q, v, system.acceleration(q, v, system.outer_force(0.0), now), now.ball, now.ball.copy())

    schedule = Schedule(2.0 * np.pi / w / _STEPS, _STEPS, turns, _STEPS // _RECORDED)
    return _end_of(problem.system, start, schedule, parameter, turns, on_progress)


def _end_of(
    system: Ring, start: Callable[[Ring], Motion], schedule: Schedule, parameter: float, turns: int, on_progress: OnProgress | None
) -> Attractor:  # fmt: skip
    on_steps = None if on_progress is None else (lambda step, total: on_progress("beside unstable orbits", step, total))

    def moved(ring: Ring) -> Record:
        begin = start(ring)
        now = ring.evaluate(begin.q, ball=begin.ball)
        # Central differences need one evaluation a step, without tangents, and make half of Newmark's error.
        explicit = schedule.dt <= _EXPLICIT * ring.damped_time_step(now.stiffness, now.damping)
        kind = default_registry().find("integrator", "central_difference" if explicit else "newmark")
        return integrate(kind.plugin(), ring, begin, schedule, on_steps)

    try:
        try:
            record, without_dashpots = moved(system), False
        except RacewayError:
            # The dashpots' force jumps where a contact closes, and a ball may have no equilibrium within the jump.
            if system.scalars[DAMPING] == 0.0:
                raise
            record, without_dashpots = moved(system.without(DAMPING)), True
    except RacewayError as why:
        return Attractor(parameter, FAILED, turns, why=str(why))
    last, w = min(_JUDGED, turns // 2), 2.0 * np.pi / (schedule.dt * _STEPS)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])
    motion = np.hstack([record.displacement / weight, record.velocity / w / weight])[-last * _RECORDED :]
    half_range = 0.5 * np.ptp(motion[:, 1:3].reshape(last, _RECORDED, 2), axis=1).max(axis=1)
    section = motion[_RECORDED - 1 :: _RECORDED]
    kind, period, second = kind_of_section(section, float(np.abs(motion[:, 5:]).max()))
    least, most = float(half_range.min()), float(half_range.max())
    return Attractor(parameter, kind, turns, period, second, least, most, "", without_dashpots, section[:, [1, 6]].copy())


def kind_of_section(section: np.ndarray, size: float) -> tuple[str, int | None, float | None]:
    """Kind, period in turns and second frequency of a section (n, k) of a motion of some size."""
    for period in range(1, _PERIODS + 1):
        if np.abs(section[period:] - section[:-period]).max() <= _BACK * size:
            return REPEATS, period, None
    n = len(section)
    # Blackman and Harris' window: side lobes of 1e-9 of the power, four bins to either side.
    k = 2.0 * np.pi * np.arange(n) / n
    window = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2.0 * k) - 0.01168 * np.cos(3.0 * k)
    power = (np.abs(np.fft.rfft((section - section.mean(axis=0)) * window[:, None], axis=0)) ** 2).sum(axis=1)
    power[:4] = 0.0
    # Any component may be the second frequency itself, or one of its harmonics that was folded back.
    for top in np.argsort(power)[::-1][:8]:
        second = _peak_bin(power, int(top)) / n
        bins = np.abs((second * np.arange(1, _HARMONICS + 1) + 0.5) % 1.0 - 0.5) * n
        near = (np.abs(np.arange(len(power))[:, None] - bins) <= 4.5).any(axis=1)
        if near.mean() < 0.7 and power[near].sum() >= _POWER * power.sum():
            for period in range(1, _PERIODS + 1):
                # A component at a fraction of the force's frequency: it comes back, but for a transient that dies out.
                if abs(second * period - round(second * period)) * n < 1.0:
                    return REPEATS, period, None
            return QUASI, None, float(second)
    return WANDERS, None, None


def _peak_bin(power: np.ndarray, top: int) -> float:
    """Frequency of a component in bins, by a parabola through the logarithms about its highest bin."""
    if not 0 < top < len(power) - 1 or min(power[top - 1 : top + 2]) <= 0.0:
        return float(top)
    lower, middle, right = np.log(power[top - 1 : top + 2])
    return float(top + 0.5 * (lower - right) / (lower - 2.0 * middle + right))
