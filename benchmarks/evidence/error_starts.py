"""The error that a result states against its true error: series of equilibria, and sudden and ramped starts.

Series of equilibria: the true value is a series of 4999 a turn, whose harmonics beyond the samples are below 1e-8.

Starts: the true value is Z of the steady motion by ``integrator.kind = "periodic"``, and every tenth of those is computed again
by Fourier collocation in time, which shares neither equations nor search with it.  Where several motions exist it may find
another one of those that the result lists.  Scenes without a steady motion are drawn anew: nothing is true of them.
"""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row
from raceway import scene_from_dict
from raceway.core.ring.orbit import steady_orbit
from raceway.core.signals.identification import stiffness
from raceway.errors import ConvergenceError, RacewayError
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from validation.error_estimate import FACTOR, SMALL, right
from validation.scenes import model_of, rotating
from validation.series_errors import SERIES, series_errors

TITLE = "Estimated against true error: series of equilibria, sudden and ramped starts"
COMMAND = "python -m benchmarks.evidence error_starts"
STARTS, SEED, SHARE = 390, 1, 0.99
STEPS = (8, 9, 10, 11, 12, 13, 15, 16, 20, 24, 30, 36, 45, 48, 60, 61, 72, 90, 120, 127, 180, 240, 300, 359, 360)
_CONFIRMED = 1e-3


@attrs.frozen
class Start:
    """A sudden or ramped start: its scene, speed over natural frequency, and damping ratio."""

    tables: dict[str, Any]
    ratio: float
    damping: float


def draw(rng: np.random.Generator) -> Start:
    """Speeds at 0.1 to 1.1 of the natural frequency along the force, half of them within a tenth of it; half undamped."""
    axial, rpm = float(10.0 ** rng.uniform(np.log10(150.0), np.log10(2000.0))), float(rng.uniform(6000.0, 15000.0))
    tables = rotating(axial, ("locked", "free")[rng.integers(2)], rpm, bool(rng.integers(2)), "newmark")
    kind, force = ("bidirectional", "unidirectional")[rng.integers(2)], float(axial * 10.0 ** rng.uniform(-2.0, -0.3))
    tables["excitation"] = {"kind": kind, "speed_rpm": rpm, "amplitude": "constant", "force": force}
    start, turns = ("static", "ramp")[rng.integers(2)], int((3, 4, 6, 12, 24)[rng.integers(5)])
    tables["integrator"] = {"kind": "newmark", "start": start, "turns": turns, "steps_per_turn": 180}
    ratio = float(rng.uniform(0.9, 1.1) if rng.integers(2) else rng.uniform(0.1, 0.9))
    model = model_of(tables)
    free = np.flatnonzero(model.system.free > 0.0)
    tangent = model.system.reduced(settle(model).stiffness + model.system.stiffness)
    along = 1.0 / np.linalg.inv(tangent)[list(free).index(1), list(free).index(1)]
    mass = max(float(ratio**2 * along / (rpm * np.pi / 30.0) ** 2), 0.05)
    damping = float(10.0 ** rng.uniform(-3.0, -1.0)) if rng.integers(2) else 0.0
    tables["rotor"] = {"mass": mass, "damping": 2.0 * damping * float(np.sqrt(along * mass))}
    return Start(tables, ratio, damping)


def fourier_value(tables: dict[str, Any]) -> complex | None:
    """Z of the steady orbit by Fourier collocation; None where that finds none."""
    model = model_of(tables)
    try:
        orbit = steady_orbit(model.system, model.excitation.period_s, settle(model).displacement, 65)
    except ConvergenceError:
        return None
    return stiffness(*(np.fft.fft(part, axis=0)[1] for part in (orbit.force, orbit.displacement)))


def motions(result: Result) -> list[complex]:
    """Z of each steady motion that a result lists."""
    listed = [one["dynamic_stiffness"] for one in result.to_dict()["motion"]["orbits"]]
    return [complex(one["real"], one["imag"]) for one in listed]


def start_rows(count: int, seed: int) -> list[Row]:
    rng = np.random.default_rng(seed)
    judged: list[tuple[float, float, float]] = []
    drawn = confirmed = asked = 0
    while len(judged) < count:
        one = draw(rng)
        drawn += 1
        try:
            steady = run(scene_from_dict({**one.tables, "integrator": {"kind": "periodic"}}))
        except RacewayError:
            continue
        true = steady.identification
        result = run(scene_from_dict(one.tables))
        found, wanted = result.identification, true.dynamic_stiffness
        estimate = result.error["total"]
        error = abs(found.dynamic_stiffness - wanted) / abs(wanted)
        of_k = abs(found.equivalent_stiffness - true.equivalent_stiffness)
        stated = result.to_dict()["identification"]["equivalent_stiffness_error"]
        judged.append((np.nan, error, np.nan) if estimate is None else (estimate, error, of_k / stated))
        if len(judged) % 10 == 0:
            other = fourier_value(one.tables)
            asked += other is not None
            close = (_CONFIRMED * min(error, 1.0) + SMALL) * abs(wanted)
            confirmed += other is not None and any(abs(other - z) < close for z in motions(steady))
    estimates, errors, k_errors = np.array(judged).T
    least = (estimates >= errors / FACTOR) | ((estimates < SMALL) & (errors < SMALL))
    both = [right(*pair) for pair in zip(estimates, errors, strict=True)]
    words = f"{drawn - count} more had no steady motion; true errors from {errors.min():.1g} to {errors.max():.1g}"
    return [
        Row(f"sudden and ramped starts whose estimate is at least a third of the true error, of {count}", int(least.sum()),
            f"at least {SHARE:.0%}", bool(least.mean() >= SHARE), COMMAND, words),
        Row("of those: estimate within a third of and three times the true error", int(sum(both)), "reported", True, COMMAND),
        Row("starts whose K is off by at most three times its stated error", int((k_errors <= FACTOR).sum()),
            f"at least {SHARE:.0%}", bool((k_errors <= FACTOR).mean() >= SHARE), COMMAND),
        Row("steady motions that Fourier collocation finds: equal to one of those told, to a thousandth of the error", f"{confirmed} of {asked}",
            "all", confirmed == asked, COMMAND, "every tenth is asked"),
    ]  # fmt: skip


def series_rows() -> list[Row]:
    out = []
    for place, (axial, force, kind, tilt, radial) in enumerate(SERIES):
        pairs = [series_errors(place, steps) for steps in STEPS]
        good = sum(right(*pair) for pair in pairs)
        ratios = [estimate / true for estimate, true in pairs if max(estimate, true) >= SMALL]
        name = f"series of {STEPS[0]} to {STEPS[-1]} equilibria a turn, {axial:g} N axial, {force:g} N {kind}, tilt {tilt}"
        name += f", radial {radial[0]:g}, {radial[1]:g} N" if any(radial) else ""
        value = f"{good} of {len(STEPS)}; estimate over true error {min(ratios):.2f} to {max(ratios):.2f}"
        limit = f"all from a third to {FACTOR:g}, or both below {SMALL:g}"
        note = f"true errors {max(true for _, true in pairs):.1g} to {min(true for _, true in pairs):.1g}"
        out.append(Row(name, value, limit, good == len(STEPS), COMMAND, note))
    return out


def rows() -> list[Row]:
    return [*series_rows(), *start_rows(STARTS, SEED)]
