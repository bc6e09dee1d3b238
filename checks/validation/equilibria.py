"""Static equilibria of random and of extreme scenes: none unsolved that has a solution, and how long they take.

The potential of the rigid ring is convex, and for three or more balls it grows in every direction, so every loaded
scene has an equilibrium.  Where the loaded balls leave a motion free at it (fewer contacts than unknowns), the program
refuses it by name; those refusals are counted apart and each is checked by the rank of the loaded balls' directions.
"""

import time
from collections.abc import Iterator
from itertools import product
from typing import Any

import attrs
import numpy as np

from checks.validation.scenes import imbalance, random_tables
from raceway import ConvergenceError
from raceway.testing import Model, model_of, solve_equilibrium

#: Residual over the sum of the loads and of the inner races' forces that counts as solved; the program's own tolerance is
#: 1e-11.  Among the extremes are loads of 1 mN under 20 kN of centrifugal force, of which rounding leaves 1e-15.
RESIDUAL, EXTREME_RESIDUAL = 1e-9, 1e-7


@attrs.define
class Tally:
    """What became of a set of scenes."""

    seconds: list[float] = attrs.field(factory=list)
    residuals: list[float] = attrs.field(factory=list)
    iterations: list[int] = attrs.field(factory=list)
    free: int = 0
    impossible: int = 0
    unsolved: list[str] = attrs.field(factory=list)

    @property
    def count(self) -> int:
        return len(self.seconds)


def loose(model: Model, q: np.ndarray) -> bool:
    """Whether the loaded balls and the shaft leave a motion of the ring free: a matter of rank, not of numbers.

    A loaded ball holds its inner groove centre in both directions of its meridian plane: by the contact's stiffness along
    the line of contact and by its load across it.
    """
    system, z = model.system, model.geometry.ball_count
    force = system.evaluate(q).contact_force
    # A ball that hangs on the inner race alone follows it: no stiffness.
    loaded = (force[:z] > 1e-9 * force[:z].max(initial=0.0)) & (force[z:] > 0.0)
    c, s = np.cos(model.azimuth)[loaded], np.sin(model.azimuth)[loaded]
    zero, one = np.zeros_like(c), np.ones_like(c)
    directions = np.concatenate([np.column_stack([one, zero, zero, s, -c]), np.column_stack([zero, c, s, zero, zero])])
    if system.stiffness.any():
        directions = np.concatenate([directions, np.eye(5)[3:]])
    free = system.free > 0.0
    values = np.linalg.svd(directions[:, free], compute_uv=False)
    return bool((values > 1e-6).sum() < free.sum())


def solve(scenes: Iterator[dict[str, Any]], residual: float = RESIDUAL) -> Tally:
    """Settle every scene; only the solution is timed, not the reading and building of the scene."""
    tally = Tally()
    for tables in scenes:
        model = model_of(tables)
        start = time.perf_counter()
        try:
            found = solve_equilibrium(model)
        except ConvergenceError as error:
            tally.seconds.append(time.perf_counter() - start)
            if "singular" in str(error) and loose(model, error.state["q"]):
                tally.free += 1
            elif "no such contact exists" in str(error):
                # Solved, then refused for what the solution says: the solution is checked as any other.
                tally.impossible += 1
                _check(model, error.state["q"], error.state["ball"], residual, tally)
            else:
                tally.unsolved.append(str(error))
            continue
        tally.seconds.append(time.perf_counter() - start)
        tally.iterations.append(found.iterations)
        _check(model, found.displacement, found.ball, residual, tally)
    return tally


def _check(model: Model, q: np.ndarray, ball: np.ndarray, residual: float, tally: Tally) -> None:
    tally.residuals.append(imbalance(model, q, ball))
    if tally.residuals[-1] > residual:
        tally.unsolved.append(f"residual {tally.residuals[-1]:.1e}")


def random_scenes(law: str, seed: int, count: int) -> Iterator[dict[str, Any]]:
    """Scenes as the issue asks: 1 N to 100 kN, F_r to 5 F_a, 0 to 100 000 r/min, 3 to 60 balls, all supports."""
    rng = np.random.default_rng(seed)
    return (random_tables(rng, law) for _ in range(count))


def part(scenes: Iterator[dict[str, Any]], share: float, seed: int) -> Iterator[dict[str, Any]]:
    """About a share of the scenes, drawn: every third of a grid would miss values of its axes."""
    rng = np.random.default_rng(seed)
    return (tables for tables in scenes if rng.random() < share)


def _scene(
    law: str, axial: float, radial: float, azimuth: float, tilt: Any, balls: int, angle: float, speed: float,
    conformity: float = 0.52, clearance: float | None = None, moment: float = 0.0,
) -> dict[str, Any]:  # fmt: skip
    pitch = max(46e-3, 1.05 * 9.525e-3 / np.sin(np.pi / balls))
    bearing: dict[str, Any] = {
        "ball_diameter": 9.525e-3, "pitch_diameter": float(pitch), "ball_count": balls,
        "conformity_inner": conformity, "conformity_outer": conformity,
    }  # fmt: skip
    bearing |= {"contact_angle_deg": angle} if clearance is None else {"radial_clearance": clearance}
    c, s = float(np.cos(azimuth)), float(np.sin(azimuth))
    return {
        "title": "extreme", "bearing": bearing, "supports": {"tilt": tilt},
        "load": {"axial": axial, "radial": [radial * c, radial * s], "moment": [moment * c, moment * s]},
        "kinematics": {"spin_speed_rpm": speed, "gyroscopic": "none", "ring_growth": False}, "contact": {"kind": law},
    }  # fmt: skip


def families(law: str) -> dict[str, Iterator[dict[str, Any]]]:
    """Extreme scenes by name; many have the load exactly towards a ball, so that symmetry can leave motions free."""
    to, tilts, counts, angles = (0.0, 0.3, 1.0), ("locked", "free", 1e4), (3, 4, 12, 60), (10.0, 15.0, 40.0)
    speeds = (0.0, 1e4, 1e5)

    def of(axial: Any, radial: Any, **more: Any) -> Iterator[dict[str, Any]]:
        for a, r, p, t, z, alpha, w in product(axial, radial, to, tilts, counts, angles, speeds):
            yield _scene(law, a, r * (abs(a) or 1.0), p, t, z, alpha, w, **more)

    def narrow_and_wide() -> Iterator[dict[str, Any]]:
        for f in (0.501, 0.6, 0.9):
            yield from of((1.0, 1e5), (0.0, 5.0), conformity=f)

    def grooves() -> Iterator[dict[str, Any]]:
        for clearance in (1e-6, 1e-5, 1e-4):
            yield from of((0.0,), (1.0, 500.0, 1e5), clearance=clearance)

    def moments() -> Iterator[dict[str, Any]]:
        for moment in (1.0, 30.0, 1e3):
            yield from (s for s in of((1e3,), (0.0,), moment=moment) if s["supports"]["tilt"] != "locked")

    return {
        "1 N axial, to 100 000 r/min": of((1.0,), (0.0, 0.1, 1.0, 5.0)), "1 mN axial": of((1e-3,), (0.0, 1.0, 5.0)),
        "1 MN axial": of((1e6,), (0.0, 1.0, 5.0)), "conformity 0.501, 0.6, 0.9": narrow_and_wide(),
        "negative axial load": of((-1.0, -1e3, -1e5), (0.0, 1.0, 5.0)),
        "no axial load, angular contact": of((0.0,), (1.0, 500.0, 1e5)),
        "no axial load, deep groove with clearance": grooves(), "moments to 1 kN m": moments(),
    }  # fmt: skip
