"""Ball pass of orbiting balls: a series of equilibria under a static radial load, its frequency and amplitude by other ways."""

from typing import Any

import numpy as np

from raceway.testing import Model, b7206c, model_of

SPEED = 9000.0


def passing_scene(turns: int = 12, steps: int = 120, **tables: Any) -> dict[str, Any]:
    """A static radial load on orbiting balls; the excitation is there to tell the turns and is next to nothing."""
    base = {
        "load": {"axial": 300.0, "radial": [600.0, 0.0]}, "kinematics": {"orbiting": True},
        "excitation": {"kind": "bidirectional", "speed_rpm": SPEED, "amplitude": "constant", "force": 1e-7},
        "integrator": {"kind": "quasi_static", "turns": turns, "steps_per_turn": steps},
    }  # fmt: skip
    return b7206c(**base, **tables)


def passing_hz(model: Model) -> float:
    """Z (w / 2) (1 - D cos(alpha) / d_m) / (2 pi), the textbook's."""
    b = model.scene.bearing
    cage = 0.5 * (1.0 - b.ball_diameter * np.cos(b.contact_angle) / b.pitch_diameter) * SPEED / 60.0
    return float(b.ball_count * cage)


def static_amplitude(tables: dict[str, Any]) -> np.ndarray:
    """(5,) first harmonic of the static displacement over one ball pitch, from 16 positions of the balls."""
    still = {k: v for k, v in tables.items() if k not in ("excitation", "integrator")} | {
        "kinematics": {"spin_speed_rpm": SPEED, "gyroscopic": "none", "ring_growth": False}
    }
    pitch, found = 360.0 / tables["bearing"].get("ball_count", 12), []
    for k in range(16):
        model = model_of({**still, "bearing": {**tables["bearing"], "first_ball_azimuth_deg": pitch * k / 16.0}})
        found.append(model.system.solve_equilibrium(model.guess)[0])
    return np.abs(np.fft.fft(found, axis=0)[1]) / 8.0
