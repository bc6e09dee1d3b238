"""Scenes with several steady motions, and one of their turns by an integration of its own."""

from typing import Any

import numpy as np

from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import dynamic_stiffness, rotating, swinging, trajectory
from raceway import Result
from raceway.testing import b7206c, ring_inertia

Tables = dict[str, Any]


class Damped(Ring):
    """A ring whose damping is a dashpot along x, y and z [N s/m], not one in each contact."""

    def damping_matrix(self, q: np.ndarray) -> np.ndarray:
        return np.diag([self.damping, self.damping, self.damping, 0.0, 0.0])


def heavy(mass: float, damping: float = 5000.0, **integrator: Any) -> Tables:
    """1000 N axial, 100 N that turn at 15 000 r/min, near resonance: the contacts soften."""
    return b7206c(
        rotor={"mass": mass, "damping": damping},
        excitation={"kind": "bidirectional", "speed_rpm": 15000, "amplitude": "constant", "force": 100.0},
        contact={"damping": 0.0},
        integrator={"kind": "newmark", **integrator},
    )


def article(axial: float, **integrator: Any) -> Tables:
    """The article's scene, its force in one direction and the same at every speed, tilt free."""
    force = {"kind": "unidirectional", "speed_rpm": 15000, "amplitude": "constant", "unbalance": 6.39e-4, "load_share": 0.5}
    return {
        "bearing": {"preset": "B7206C"}, "supports": {"tilt": "free"}, "rotor": {"mass": 2.0}, "load": {"axial": axial},
        "excitation": {**force, "reference_speed_rpm": 10980.0}, "contact": {"damping": 0.0},
        "kinematics": {"gyroscopic": "none", "ring_growth": False},
        "integrator": {"kind": "newmark", **integrator},
    }  # fmt: skip


def by_integration(result: Result, damping: float = 0.0) -> tuple[complex, float, float]:
    """Z, the largest multiplier, and what a turn does not close by over its amplitude, of a turn that begins on the motion."""
    model, simulation = result.model, result.simulation
    assert simulation is not None and model.excitation is not None
    w = 2.0 * np.pi / model.excitation.period_s
    ring = Damped(
        9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522, spin_speed=w if model.scene.kinematics.ball_inertia else 0.0,
        damping=damping, spin=ring_inertia(model.problem.bearing)[2] * w,
    )  # fmt: skip
    force = (rotating if model.excitation.sense else swinging)(model.excitation.amplitude_n, w)
    times = np.linspace(0.0, 2.0 * np.pi / w, 181)
    mass, load, free = model.system.mass, model.system.load, model.system.free
    begin = simulation.whole.displacement[-1], simulation.whole.velocity[-1]
    q, _, flow = trajectory(ring, mass, load, force, free, *begin, times, 1e-10, variational=True)
    gap = float(np.abs(q[-1] - q[0])[:3].max() / np.ptp(q[:, 1]))
    return dynamic_stiffness(times[:-1], q[:-1], force, w), float(np.abs(np.linalg.eigvals(flow)).max()), gap
