"""Observed order of each transient integrator: slope of the error over step halvings.

Linear oscillator: closed form.  Bearing under a suddenly applied turning force: without damping an independent DOP853
solution; with heavily damped contacts (where the balls' own rates matter) the same integrator with a much smaller step.
"""

from typing import Any

import attrs
import numpy as np

from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import rotating as rotating_force
from checks.validation.reference.shooting import trajectory
from checks.validation.scenes import rig_force, rotating
from raceway import scene_from_dict
from raceway.extend import Motion, Schedule, System, integrate
from raceway.testing import Model, model_of, ring_inertia, simulate, solve_equilibrium

INTEGRATORS = ("newmark", "generalized_alpha", "central_difference")
#: Deviation of the fitted slope from 2 that is put down to the range of steps.
MARGIN = 0.1
HALVINGS = 5
TURNS = 2


def order(steps: np.ndarray, errors: np.ndarray) -> float:
    """Slope of log error over log step, least squares."""
    return float(-np.polyfit(np.log(steps), np.log(errors), 1)[0])


def oscillator(damping_ratio: float) -> tuple[System, float, float]:
    """A linear system without contacts, its natural frequency w0 [rad/s] and excitation speed [rad/s].  One ball far from
    both races, so that only the linear parts act: y'' + 2 D w0 y' + w0^2 y = F cos(W t) / m."""
    tables = rotating(1.0, "locked", 12000.0, False, "newmark")
    tables["bearing"] = {
        "ball_diameter": 0.01, "pitch_diameter": 0.1, "ball_count": 1, "conformity_inner": 0.6, "conformity_outer": 0.6,
        "radial_clearance": 3e-3,
    }  # fmt: skip
    mass, w0, speed = 2.0, 1.7 * 400.0 * np.pi, 400.0 * np.pi
    system = attrs.evolve(
        model_of(tables).system, mass=np.eye(5) * mass, damping=np.eye(5) * 2.0 * damping_ratio * w0 * mass,
        stiffness=np.eye(5) * w0**2 * mass, free=np.array([0.0, 1.0, 0.0, 0.0, 0.0]), load=np.zeros(5),
    )  # fmt: skip
    return system, w0, speed


def exact(system: System, w0: float, speed: float, ratio: float, times: np.ndarray) -> np.ndarray:
    """y (n,) from rest at y = 0, closed form."""
    force, mass = float(np.hypot(*system.outer_force(0.0)[1:3])), system.mass[1, 1]
    line = force / mass / (w0**2 - speed**2 + 2j * ratio * w0 * speed)
    wd = w0 * np.sqrt(1.0 - ratio**2)
    a, slope = -line.real, -(1j * speed * line).real
    b = (slope + ratio * w0 * a) / wd
    free = np.exp(-ratio * w0 * times) * (a * np.cos(wd * times) + b * np.sin(wd * times))
    return (line * np.exp(1j * speed * times)).real + free


def linear_errors(integrator: str, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Steps per turn and largest error over largest motion, TURNS turns from rest."""
    system, w0, speed = oscillator(ratio)
    method = scene_from_dict(rotating(1.0, "locked", 12000.0, False, integrator)).integrator.method
    held = np.array([-system.scalars[0], 0.0, 0.0, 0.0, 0.0])  # midway: the ball is far from both races
    ball = system.evaluate(held).ball
    start = Motion(held, np.zeros(5), system.outer_force(0.0) * system.free / system.mass[1, 1], ball, ball.copy())
    counts = 60 * 2 ** np.arange(HALVINGS)
    errors = []
    for count in counts:
        record = integrate(method, system, start, Schedule(2.0 * np.pi / speed / count, int(count), TURNS))
        wanted = exact(system, w0, speed, ratio, record.time)
        errors.append(np.abs(record.displacement[:, 1] - wanted).max() / np.abs(wanted).max())
    return counts, np.array(errors)


def bearing(integrator: str, tilt: str, inertia: bool, damping: float, steps_per_turn: int) -> Model:
    """The rig's force, applied suddenly to the resting ring: its natural frequencies ring along with the turning force."""
    tables: dict[str, Any] = rotating(1000.0, tilt, 12000.0, inertia, integrator)
    tables["contact"] = {"damping": damping}
    tables["integrator"] = {"kind": integrator, "turns": TURNS, "steps_per_turn": steps_per_turn, "start": "static"}
    return model_of(tables)


def motion(integrator: str, tilt: str, inertia: bool, damping: float, steps_per_turn: int, keep: int) -> np.ndarray:
    """(n, 2) radial motion at ``keep`` samples a turn."""
    model = bearing(integrator, tilt, inertia, damping, steps_per_turn)
    whole = simulate(model, solve_equilibrium(model)).whole
    every = len(whole.time) // (TURNS * keep)
    return whole.displacement[every - 1 :: every, 1:3]


def independent(tilt: str, keep: int) -> np.ndarray:
    """(n, 2) the same motion without damping and with weightless balls, by DOP853 on the reference's equations."""
    model = bearing("newmark", tilt, False, 0.0, 360)
    start, w = solve_equilibrium(model).displacement, 12000.0 * np.pi / 30.0
    _, _, polar = ring_inertia(model.problem.bearing)
    ring = Ring(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522, spin=polar * w)
    times = np.linspace(0.0, TURNS * 2.0 * np.pi / w, TURNS * keep + 1)
    system = model.system
    q, _, _ = trajectory(
        ring, system.mass, system.load, rotating_force(rig_force(12000.0), w), system.free, start, np.zeros(5), times
    )
    return q[1:, 1:3]


def contact_errors(
    integrator: str, tilt: str, inertia: bool, damping: float, wanted: np.ndarray | None, coarsest: int
) -> tuple[np.ndarray, np.ndarray]:
    """Steps per turn and largest error over largest motion; without ``wanted`` against 16 times the finest steps."""
    keep = 60
    counts = coarsest * 2 ** np.arange(HALVINGS)
    if wanted is None:
        wanted = motion(integrator, tilt, inertia, damping, int(counts[-1]) * 16, keep)
    found = [motion(integrator, tilt, inertia, damping, int(count), keep) for count in counts]
    return counts, np.array([np.abs(each - wanted).max() / np.abs(wanted).max() for each in found])
