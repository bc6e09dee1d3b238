"""The rigid model in full depth: ball pass, pairs, friction, gyroscopic moments."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from raceway import build_model, make_plan, scene_from_dict
from raceway.bodies.model import Model
from raceway.core.ring.energy import energy_balance
from raceway.core.ring.friction import friction_energy
from raceway.core.signals.lines import phasors, sharpest
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import simulate
from raceway.studies.verify.study import verify

TITLE = "The rigid model in full depth"
BALLS, RUBBING = "python -m pytest tests/depth/test_orbiting.py", "python -m pytest tests/depth/test_friction.py"
SPINNING, PAIRS = "python -m pytest tests/depth/test_gyroscopic.py", "raceway verify"


def _model(**tables: Any) -> Model:
    scene = scene_from_dict({"title": "depth", "bearing": {"preset": "B7206C"}, **tables})
    return build_model(scene, make_plan(scene))


def rows() -> list[Row]:
    return [*_ball_pass(), *_pairs(), *_friction(), *_gyroscopic()]


def _ball_pass() -> list[Row]:
    out, rpm = [], 9000.0
    load = {"axial": 300.0, "radial": [600.0, 0.0]}
    for tilt in ("locked", "free"):
        common: dict[str, Any] = {"load": load, "supports": {"tilt": tilt}}
        model = _model(
            kinematics={"orbiting": True},
            excitation={"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": 1e-7},
            integrator={"kind": "quasi_static", "turns": 12, "steps_per_turn": 120},
            **common,
        )
        record = simulate(model, settle(model)).whole
        b = model.scene.bearing
        ratio = b.ball_diameter * np.cos(b.contact_angle) / b.pitch_diameter
        expected = 0.5 * b.ball_count * (1.0 - ratio) * rpm / 60.0
        found = sharpest(record.time, record.displacement[:, 1], expected, 0.03)
        note = f"{found:.4f} Hz against Z/2 (1 - D cos a/d_m) f = {expected:.4f} Hz"
        out.append(below(f"error of the ball-pass frequency, tilt {tilt}", abs(found / expected - 1.0), 1e-3, BALLS, note))
        ends = []
        for azimuth in (0.0, 180.0 / b.ball_count):
            bearing = {"preset": "B7206C", "first_ball_azimuth_deg": azimuth}
            still = _model(**common, bearing=bearing, kinematics={"spin_speed_rpm": rpm})
            ends.append(load["radial"][0] / still.system.settle(still.guess)[0][1])
        static = 0.5 * abs(600.0 / ends[0] - 600.0 / ends[1])
        line = abs(phasors(record.time, record.displacement[:, 1:2], [expected])[0, 0])
        note = (
            f"{1e9 * line:.4f} nm; secant stiffness {ends[0] / 1e6:.4f} and {ends[1] / 1e6:.4f} N/um half a ball pitch apart"
        )
        out.append(below(f"error of its amplitude, tilt {tilt}", abs(line / static - 1.0), 0.01, BALLS, note))
    return out


def _pairs() -> list[Row]:
    found = verify(only=["nsk-7206C-stiffness", "nsk-7206A-stiffness"]).rows
    return [
        below(
            f"{row.case}: {row.quantity}: error",
            row.error or 0.0,
            row.tolerance or 0.0,
            PAIRS,
            f"{row.computed:.2f} against {row.reference:g}",
        )
        for row in found
        if "as pair" in row.quantity and row.computed is not None
    ]


def _friction() -> list[Row]:
    out = []
    for friction in (0.003, 0.03, 0.3, 1.0):
        model = _model(
            load={"axial": 1000.0},
            contact={"friction": friction},
            rotor={"mass": 2.0},
            supports={"tilt": "free"},
            excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
            integrator={"turns": 3, "steps_per_turn": 360},
        )
        whole = simulate(model, settle(model)).whole
        lost = friction_energy(model.system, whole).lost
        least = -float(np.diff(lost).min())
        note = f"{1e6 * lost[-1]:.3g} uJ lost in 3 turns; rounding of the differences is 1e-15 J"
        out.append(below(f"energy that a step gives back, friction {friction:g}, J", least, 1e-15, RUBBING, note))
        drift = energy_balance(model.system, whole).drift
        out.append(
            below(
                f"drift of the energy balance, friction {friction:g}",
                drift,
                5e-3,
                RUBBING,
                "360 steps a turn; second order in the step while contacts stick, first in what slides",
            )
        )
    return out


def _gyroscopic() -> list[Row]:
    def state(hypothesis: str) -> tuple[float, float]:
        model = _model(load={"axial": 100.0}, kinematics={"spin_speed_rpm": 40000.0, "gyroscopic": hypothesis})
        q, ball, _ = model.system.settle(model.guess)
        return float(q[0]), float(model.system.evaluate(q, ball=ball).stiffness[1, 1])

    x, k = state("none")
    out = []
    for hypothesis in ("outer_race", "shared"):
        x_g, k_g = state(hypothesis)
        effect = max(abs(x_g / x - 1.0), abs(k_g / k - 1.0))
        note = f"axial displacement {100 * (x_g / x - 1):+.1f} %, radial stiffness {100 * (k_g / k - 1):+.1f} %"
        name = f"effect of gyroscopic moments at 40 000 r/min and 100 N axial, {hypothesis}"
        out.append(Row(name, effect, "tens of percent: 0.1 to 1", 0.1 < effect < 1.0, SPINNING, note))
    return out
