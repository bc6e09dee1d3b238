"""What a ring does where its steady orbit is unstable: a time integration that begins beside it, and its Poincaré section.

Notes
-----
The section holds the state once a turn.  It comes back after m turns: an orbit of m turns.  Else its spectrum tells: lines at
multiples of one frequency, modulo one a turn, belong to a quasi-periodic motion, whose section is a closed curve; what else
does not repeat is chaotic, or has not settled in the turns that were integrated.

References
----------
Nayfeh, Balachandran, Applied Nonlinear Dynamics (1995), sections 4.1 and 4.2.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.branch import Point
from raceway.core.periodic.sampling import states
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Motion, Schedule
from raceway.errors import RacewayError
from raceway.integrators.newmark import Newmark
from raceway.storage.tables import Tables

OnProgress = Callable[[str, int, int], None]
#: Steps a turn, and those that are recorded; the step's error moves a settled orbit by some 1e-4.
_STEPS, _RECORDED = 360, 8
#: Disturbance at the start over the orbit's size, along the disturbance that grows most.
_KICK = 1e-2
#: Turns after which an orbit may come back, and by what it may miss itself over its size.
_PERIODS, _BACK = 8, 1e-4
#: Turns of the section that is judged; harmonics of the second frequency, and the share of the section's power they have.
_JUDGED, _HARMONICS, _POWER = 512, 12, 0.999

REPEATS, QUASI, WANDERS, FAILED = "repeats", "quasi-periodic", "does not repeat", "not integrated"


@attrs.frozen(eq=False)
class Instead:
    """The motion beside an unstable orbit.

    Attributes
    ----------
    parameter : value of the key;  kind : REPEATS, QUASI, WANDERS or FAILED;  turns : integrated
    period : turns after which it comes back, of REPEATS;  second : frequency in cycles a turn, of QUASI, at most 1/2
    least, most : smallest and largest half range of the radial displacement in a turn [m]
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
    section: np.ndarray = attrs.field(factory=lambda: np.empty((0, 2)))

    @property
    def words(self) -> str:
        """In a sentence."""
        if self.kind == FAILED:
            return f"not integrated: {self.why}"
        assert self.least is not None and self.most is not None
        between = f"half range {1e6 * self.least:.4g} to {1e6 * self.most:.4g} µm a turn"
        if self.kind == REPEATS:
            after = "every turn: it settles on another orbit" if self.period == 1 else f"after {self.period} turns"
            return f"repeats {after}, {between}"
        if self.kind == QUASI:
            return f"quasi-periodic, second frequency {self.second:.5g} a turn of the force, {between}"
        return f"does not repeat in {self.turns} turns, {between}"

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "section": self.section.tolist(), "words": self.words}


def instead(point: Point, turns: int, on_progress: OnProgress | None = None) -> Instead:
    """Integrate from beside an unstable orbit and say what comes of it."""
    problem, solved = point.solved.problem, point.solved
    system, w, free = problem.system, problem.speed, problem.free
    values, vectors = np.linalg.eig(point.transfer)
    way = vectors[:, np.argmax(np.abs(values))].real
    n = len(free)
    way *= _KICK * solved.size / max(float(np.abs(way / np.tile(problem.weight[free], 2)).max()), 1e-300)
    q, v, _, ball, _ = (part[0] for part in states(solved, np.zeros(1)))
    q, v = q.copy(), w * v
    q[free] += way[:n]
    v[free] += w * way[n:]
    try:
        now = system.evaluate(q, v, ball=ball)
        start = Motion(q, v, system.acceleration(q, v, system.outer_force(0.0), now), now.ball, now.ball.copy())
        schedule = Schedule(2.0 * np.pi / w / _STEPS, _STEPS, turns, _STEPS // _RECORDED)
        told = None if on_progress is None else (lambda done, total: on_progress("beside unstable orbits", done, total))
        record = integrate(Newmark(), system, start, schedule, told)
    except RacewayError as why:
        return Instead(float(point.parameter), FAILED, turns, why=str(why))
    last = min(_JUDGED, turns // 2)
    motion = np.hstack([record.displacement / problem.weight, record.velocity / w / problem.weight])
    radial = record.displacement[:, 1:3].reshape(turns, _RECORDED, 2)[-last:]
    swing = 0.5 * np.ptp(radial, axis=1).max(axis=1)
    section = motion[_RECORDED - 1 :: _RECORDED][-last:]
    kind, period, second = judged(section, float(np.abs(motion[:, 5:]).max()))
    return Instead(
        float(point.parameter),
        kind,
        turns,
        period,
        second,
        float(swing.min()),
        float(swing.max()),
        "",
        section[:, [1, 6]].copy(),
    )


def judged(section: np.ndarray, size: float) -> tuple[str, int | None, float | None]:
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
    # Any line may be the second frequency's own, or one of its harmonics that was folded back.
    for top in np.argsort(power)[::-1][:8]:
        second = _refined(power, int(top)) / n
        bins = np.abs((second * np.arange(1, _HARMONICS + 1) + 0.5) % 1.0 - 0.5) * n
        near = (np.abs(np.arange(len(power))[:, None] - bins) <= 4.5).any(axis=1)
        if near.mean() < 0.7 and power[near].sum() >= _POWER * power.sum():
            for period in range(1, _PERIODS + 1):
                # A line at a fraction of the force's frequency: it comes back, but for a rest that dies out.
                if abs(second * period - round(second * period)) * n < 1.0:
                    return REPEATS, period, None
            return QUASI, None, float(second)
    return WANDERS, None, None


def _refined(power: np.ndarray, top: int) -> float:
    """Place of a line in bins, by a parabola through the logarithms about its highest bin."""
    if not 0 < top < len(power) - 1 or min(power[top - 1 : top + 2]) <= 0.0:
        return float(top)
    left, here, right = np.log(power[top - 1 : top + 2])
    return float(top + 0.5 * (left - right) / (left - 2.0 * here + right))
