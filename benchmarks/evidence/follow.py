"""Branches of steady orbits: folds and backbones in closed form, harmonic balance, time integration, monodromy, cost."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.direct import directly
from raceway.core.periodic.doubling import doubled
from raceway.core.periodic.sampling import displacements, states
from raceway.core.periodic.special import DOUBLING, FOLD, PAIR, Special, special_points
from raceway.core.schemes.drivers import integrate
from raceway.core.signals.identification import stiffness
from raceway.core.stepping.record import Motion, Schedule
from raceway.integrators.newmark import Newmark
from raceway.studies.follow.result import Followed
from validation.followed import OVER, SCENE, beside, by_harmonic_balance, by_integration, on_the_way, z_of
from validation.oscillators import Oscillator, Pressed, natural_frequency

TITLE = "Branches of steady orbits"
COMMAND = "python -m benchmarks.evidence follow"
_SCENE = "B7206C, 400 N, tilt free, 40 N along one direction, rotor.damping 200 N s/m"


def rows() -> list[Row]:
    return [*_folds(), *_backbone(), *_curve(), *_doubled()]


def _walk(branch: Branch, here: Point, size: float, until: Any) -> tuple[list[Point], list[Special]]:
    points, found = [], []
    while not until(here):
        there = branch.step(here, size)
        found += special_points(branch, here, there, size)
        size *= branch.growth(there)
        here = there
        points.append(here)
    return points, found


def _folds() -> list[Row]:
    one = Oscillator(damping=2e-4, factor=1e-3, force=2e-4)
    branch = Branch(one.problem, 1e-3, 1.0, 1e-10, 512, aim=1e-3)
    first = branch.start(one.orbit(0.995, one.force / (1.0 - 0.995**2)), 0.995)
    _, found = _walk(branch, first, 0.1, lambda point: point.parameter > 1.002)
    points = [special.point for special in found if special.kind == FOLD]
    sizes = [float(np.abs(point.solved.path.q[:, 0]).max()) for point in points]
    wanted = one.folds([(point.parameter, size) for point, size in zip(points, sizes, strict=True)])
    note = "closed form: the first harmonic alone, which leaves (b A^2 / k)^2 3/128 = 2e-8 of w out"
    off = [abs(point.parameter / w - 1.0) for point, (w, _) in zip(points, wanted, strict=True)]
    return [below("Duffing oscillator: w of both folds against the closed form, relative", max(off), 1e-6, COMMAND, note)]


def _backbone() -> list[Row]:
    one = Oscillator(stiffness=0.0, factor=2.0, exponent=1.5, force=1e-8)
    start = float(natural_frequency(2.0, 1.5, 1.0, np.array(1.0)))
    branch = Branch(one.problem, start, 1.0, 1e-6, 8, aim=1e-3)
    points, _ = _walk(branch, branch.start(one.orbit(start, 1.0, 80), start), 0.01, lambda point: _amplitude(point) > 10.0)
    sizes = np.array([_amplitude(point) for point in points])
    off = np.abs(np.array([point.parameter for point in points]) / natural_frequency(2.0, 1.5, 1.0, sizes) - 1.0)
    note = f"{len(points)} orbits, amplitudes {sizes.min():.3g} to {sizes.max():.3g}, under a force of 1e-8 of the spring's"
    words = "backbone of a mass on k x^1.5: frequency against c A^(1/4), relative"
    return [below(words, float(off.max()), 1e-6, COMMAND, note)]


def _amplitude(point: Point) -> float:
    return float(np.abs(displacements(point.solved, np.array([0.0, np.pi]))[:, 0]).max())


def _curve() -> list[Row]:
    curve, spent = rw.follow(SCENE, OVER), np.inf
    for _ in range(3):
        begun = time.process_time()
        curve = rw.follow(SCENE, OVER)
        spent = min(spent, time.process_time() - begun)
    kinds = [label.kind for label in curve.labels]
    told = f"{kinds.count(FOLD)} folds, {kinds.count(PAIR)} Neimark-Sacker points, {len(curve.unstable)} unstable stretches"
    known = len(curve.rows) >= 200 and kinds.count(FOLD) == 2 and curve.end == "" and len(curve.unstable) == 3
    note = f"{_SCENE}, {OVER}; {len(curve.rows)} orbits, all special points located; without imports and compilation"
    result = [
        Row("B7206C: what the curve of at least 200 orbits has", told, "2 folds, unstable stretches", known, COMMAND, note),
        below("processor time of the curve [s]", spent, 5.0, COMMAND, note),
    ]
    fold = next(label.point for label in curve.labels if label.kind == FOLD)
    assert fold is not None
    points = [*beside(fold), *(label.point for label in curve.labels if label.kind == PAIR and label.point is not None)]
    where = "on either side of a fold and at Neimark-Sacker points, the unstable ones too"
    balance, turn, flow = [], [], []
    for point in points:
        z = z_of(point)
        balance.append(abs(by_harmonic_balance(point) / z - 1.0))
        by_turn, multipliers, _ = by_integration(point)
        turn.append(abs(by_turn / z - 1.0))
        own = point.floquet.multipliers
        flow.append(max(float(np.abs(own - multiplier).min()) for multiplier in multipliers))
    return [
        *result,
        below(
            "Z against harmonic balance of the reference ring, relative",
            max(balance),
            1e-4,
            COMMAND,
            f"24 harmonics; {where}",
        ),
        below("Z against a turn of the reference ring by DOP853, relative", max(turn), 1e-6, COMMAND, where),
        below("multipliers against the monodromy matrix of the reference ring", max(flow), 1e-5, COMMAND, where),
        *_settled(curve),
    ]


def _settled(curve: Followed) -> list[Row]:
    """Transients of two step sizes, extrapolated, that end on stable orbits."""
    fold = [label.point for label in curve.labels if label.kind == FOLD][1]
    assert fold is not None
    upper = next(point for point in beside(fold, 3) if point.floquet.verdict == "stable")
    result = []
    for point, turns, words in (
        (on_the_way(12000.0), 1200, "from rest"), (upper, 2000, "from 5 % beside the upper orbit between the folds")
    ):  # fmt: skip
        coarse, fine = (_transient(point, turns, steps, words == "from rest") for steps in (720, 1440))
        off = abs((fine + (fine - coarse) / 3.0) / z_of(point) - 1.0)
        note = f"Newmark at 720 and 1440 steps a turn, extrapolated; largest multiplier {point.floquet.largest:.5f}"
        quantity = f"Z at {point.parameter:.0f} r/min against {turns} turns {words}, relative"
        result.append(below(quantity, off, 1e-6, COMMAND, note))
    return result


def _transient(point: Point, turns: int, steps: int, rest: bool) -> complex:
    """Z [N/m] of the last turn."""
    problem, solved = point.solved.problem, point.solved
    system, w = problem.system, problem.speed
    q, v, _, ball, _ = (part[0] for part in states(solved, np.zeros(1)))
    mean = displacements(solved, 2.0 * np.pi * np.arange(64) / 64).mean(axis=0)
    q, v = (mean, np.zeros(5)) if rest else (mean + 1.05 * (q - mean), 1.05 * w * v)
    now = system.evaluate(q, v, ball=ball)
    start = Motion(q.copy(), v, system.acceleration(q, v, system.outer_force(0.0), now), now.ball, now.ball.copy())
    dt = 2.0 * np.pi / w / steps
    first = integrate(Newmark(), system, start, Schedule(dt, steps, turns - 1, steps))
    last = integrate(Newmark(), system, first.final, Schedule(dt, steps, 1, 1, first=steps * (turns - 1)))
    turned = 2.0 / steps * np.exp(-1j * w * last.time)
    return complex(stiffness(turned @ last.force, turned @ last.displacement))


def _doubled() -> list[Row]:
    one = Pressed()
    q = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    first = directly(one.problem(2.3), q, one.problem(2.3).system.evaluate(q).stiffness, 1e-8).solved
    branch = Branch(one.problem, 0.1, first.size, 1e-7, 512, aim=1e-3)
    _, found = _walk(branch, branch.start(first, 2.3, -1.0), 0.1, lambda point: point.parameter < 1.7)
    flip = next(special.point for special in found if special.kind == DOUBLING)
    longer, here = doubled(branch, flip)
    points, _ = _walk(longer, here, 0.05, lambda point: abs(point.parameter - flip.parameter) > 0.05)
    last, amplitude = points[-1], points[-1].solved.size
    path, w = last.solved.path, last.solved.problem.speed
    section = one.section(last.parameter, (1.01 * path.q[0, 0], 1.01 * w * path.v[0, 0]), 2000)[-2:, 0]
    own = displacements(last.solved, np.array([0.0, 2.0 * np.pi]))[:, 0]
    off = min(np.abs(section - own).max(), np.abs(section - own[::-1]).max()) / amplitude
    note = f"a mass on a Hertzian contact at {last.parameter:.4f} times its natural frequency, begun 1 % off; DOP853 at 1e-9"
    return [below("period-2 orbit against a Poincaré section of 2000 turns, over its size", float(off), 1e-5, COMMAND, note)]
