"""The consistent tangent: symmetric for conservative scenes, and equal to central differences of the force."""

from typing import Any

import numpy as np

from raceway.testing import Model

SYMMETRY, DIFFERENCES = 1e-9, 1e-6


def cases() -> dict[str, dict[str, Any]]:
    """Named scenes: weightless and heavy balls, tilts, clearance, radial load, moments, partly unloaded balls."""
    preset, groove = {"preset": "B7206C"}, {
        "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": 9, "conformity_inner": 0.52,
        "conformity_outer": 0.53, "radial_clearance": 15e-6,
    }  # fmt: skip
    still: dict[str, Any] = {"ball_inertia": False}

    def turning(rpm: float) -> dict[str, Any]:
        return {"ball_inertia": True, "spin_speed_rpm": rpm, "gyroscopic": "none", "ring_growth": False}

    def scene(
        bearing: dict[str, Any], tilt: Any, axial: float, radial: list[float], spin: dict[str, Any], **more: Any
    ) -> dict[str, Any]:
        load = {"axial": axial, "radial": radial, "moment": more.pop("moment", [0.0, 0.0])}
        return {
            "title": "tangent", "bearing": bearing, "supports": {"tilt": tilt}, "load": load, "kinematics": spin, **more
        }  # fmt: skip

    penalty = {"contact": {"kind": "penalty"}}
    return {
        "axial load, tilt locked": scene(preset, "locked", 1000.0, [0.0, 0.0], still),
        "axial load, tilt free, 15 000 r/min": scene(preset, "free", 1000.0, [0.0, 0.0], turning(15e3)),
        "radial load, some balls unloaded": scene(preset, "locked", 400.0, [600.0, 250.0], still),
        "radial load, some balls unloaded, 15 000 r/min": scene(preset, "locked", 400.0, [600.0, 250.0], turning(15e3)),
        "radial load, tilt free, 15 000 r/min": scene(preset, "free", 400.0, [500.0, 100.0], turning(15e3)),
        "moments against a shaft, 40 000 r/min": scene(
            preset, 1e5, 1000.0, [300.0, -200.0], turning(40e3), moment=[8.0, 5.0]
        ),
        "clearance, radial load, tilt free": scene(groove, "free", 200.0, [2000.0, 900.0], still),
        "clearance, radial load, 30 000 r/min": scene(groove, "locked", 500.0, [2000.0, 900.0], turning(30e3)),
        "light load, 100 000 r/min": scene(preset, "locked", 20.0, [5.0, 3.0], turning(1e5)),
        "penalty law, radial load, tilt free": scene(preset, "free", 400.0, [500.0, 100.0], turning(15e3), **penalty),
        "tilt arm d_m / 2": scene({**preset, "tilt_arm": "pitch"}, "free", 400.0, [500.0, 100.0], turning(15e3)),
    }


def asymmetry(matrix: np.ndarray, arm: float) -> float:
    """Largest difference to the transpose over the largest entry, tilts taken as lengths at the arm."""
    weight = np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm])
    scaled = weight[:, None] * matrix * weight
    return float(np.abs(scaled - scaled.T).max() / np.abs(scaled).max())


def deviation(model: Model, q: np.ndarray, ball: np.ndarray) -> float:
    """Largest difference to central differences over the largest entry, smallest over a few step lengths.  Differences of
    fourth order; too long a step bends over the opening of a contact, too short a one drowns in rounding."""
    arm = model.system.arm
    weight = np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm])
    tangent = model.system.evaluate(q, ball=ball).stiffness * weight[:, None] * weight
    best = np.inf
    for size in (3e-9, 3e-10, 1e-10, 3e-11):
        columns = []
        for i in range(5):
            step = np.zeros(5)
            step[i] = size * weight[i]
            force = [model.system.evaluate(q + n * step, ball=ball).force for n in (-2, -1, 1, 2)]
            columns.append((force[0] - 8.0 * force[1] + 8.0 * force[2] - force[3]) / (12.0 * size) * weight)
        best = min(best, np.abs(np.column_stack(columns) - tangent).max() / np.abs(tangent).max())
    return float(best)
