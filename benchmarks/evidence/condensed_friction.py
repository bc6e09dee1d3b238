"""Nodal contacts: friction at points against Mindlin and against resultants, inertia of balls against its linear theory."""

from __future__ import annotations

import time
from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence.condensed_patches import tables

TITLE = "Condensed bodies: friction at surface points, moments and inertia of balls"
COMMAND = "python -m benchmarks.evidence condensed_friction"
#: Coefficient and load [N] of the single contact.
MU, LOAD = 0.1, 300.0


def rows() -> list[Row]:
    return [*_mindlin(), *_beside_resultants(), *_moments(), *_inertia()]


def _mindlin() -> list[Row]:
    """One contact of 8 points along a semi-axis, pressed by 300 N and pulled along the groove."""
    from raceway.core.patches.friction import Friction
    from validation.reference.mindlin import Mindlin
    from validation.single import single

    case = single(8, LOAD, shear=True)
    answer = case.at_load(LOAD)[1]
    a, b = (float(axis) for axis in case.ellipse.semi_axes(LOAD))
    mindlin = Mindlin(a, b, 212e9, 0.29, MU * float(answer.load.sum()))
    none = np.zeros(case.patch.rows * case.patch.columns)
    friction = Friction(case.patch, MU)

    def at_force(pull: float) -> tuple[float, Any]:
        low, high = 0.0, 4.0 * float(mindlin.displacement(0.999 * mindlin.limit))
        for _ in range(50):
            middle = 0.5 * (low + high)
            found = friction.pull(answer.nodes, answer.load, middle, none)
            low, high = (middle, high) if found.force < pull else (low, middle)
        return middle, found

    out, rest = [], []
    word = "single contact, 300 N, 8 points per semi-axis"
    for share in (0.25, 0.5, 0.75, 0.9):
        pull = share * mindlin.limit
        moved, found = at_force(pull)
        closed = float(mindlin.displacement(pull))
        rest.append(1e9 * (moved - closed) / pull)
        note = f"Mindlin {1e6 * closed:.4g} um; the rest is what finite bodies give less than half-spaces"
        out.append(
            near(f"{word}, pulled by {share:g} mu Q: displacement over Mindlin's", moved / closed, 1.0, 0.03, COMMAND, note)
        )
        sticks, expected = float((found.sliding == 0).mean()), mindlin.stick_share(pull)
        note = f"c/a = {np.sqrt(sticks):.3f}, Cattaneo's {np.sqrt(expected):.3f}; tolerance: half a row around the ellipse"
        out.append(
            near(
                f"{word}, pulled by {share:g} mu Q: share of points that stick over Cattaneo's",
                sticks / expected,
                1.0,
                0.1,
                COMMAND,
                note,
            )
        )
    words = ", ".join(f"{value:.2f}" for value in rest)
    note = f"{words} nm/N at 0.25, 0.5, 0.75, 0.9 mu Q, of {1e9 * mindlin.compliance:.1f}: a structural compliance, whatever the pull"
    out.append(below(f"{word}: (displacement - Mindlin's) / pull, spread, nm/N", max(rest) - min(rest), 0.3, COMMAND, note))
    slides = friction.pull(answer.nodes, answer.load, 3e-6, none).force
    out.append(near(f"{word}, pulled further: force over mu Q", slides / mindlin.limit, 1.0, 1e-9, COMMAND))
    end, first = at_force(0.75 * mindlin.limit)
    slip, lost = first.slip, 0.0
    for place in np.concatenate([np.linspace(end, -end, 80)[1:], np.linspace(-end, end, 80)[1:]]):
        found = friction.pull(answer.nodes, answer.load, place, slip)
        slip, lost = found.slip, lost + found.lost
    loop = mindlin.loop(0.75 * mindlin.limit)
    out.append(near(f"{word}, swing of 0.75 mu Q: energy lost over Mindlin's loop", lost / loop, 1.0, 0.03, COMMAND))
    return out


def _run(points: int | None, **changes: Any) -> tuple[dict[str, Any], float]:
    from raceway import scene_from_dict
    from raceway.pipeline.run import run

    made = {**tables(points, "locked"), "load": {"axial": 1000.0}, "rotor": {"mass": 2.0}}
    for name, table in changes.items():
        made[name] = {**made.get(name, {}), **table}
    begin = time.process_time()
    found = run(scene_from_dict(made)).to_dict()
    return found, time.process_time() - begin


def _beside_resultants() -> list[Row]:
    """A force that rotates on a bearing under 1 kN: points that slip one by one, and contacts that slip as a whole."""
    out = []
    for force, within in ((200.0, 0.05), (600.0, 0.05)):
        both = []
        for points in (4, None):
            both.append(
                _run(
                    points, contact={"friction": 0.03}, kinematics={"ball_inertia": False},
                    excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": force},
                    integrator={"kind": "quasi_static", "turns": 3, "steps_per_turn": 48},
                )
            )  # fmt: skip
        (points_, seconds), (whole, _) = both
        word = f"rotating {force:g} N on 1 kN, friction 0.03, 4 points against resultants"
        pairs = [
            (one["identification"]["equivalent_stiffness"], one["identification"]["equivalent_damping"])
            for one in (points_, whole)
        ]
        note = f"{1e-6 * pairs[0][0]:.4g} and {1e-6 * pairs[1][0]:.4g} N/um; {seconds:.0f} CPU-s"
        out.append(near(f"{word}: stiffness", pairs[0][0] / pairs[1][0], 1.0, within, COMMAND, note))
        why = "a resultant has Mindlin's first stiffness until it slides, points give half as much again before they do"
        note = f"{pairs[0][1]:.4g} and {pairs[1][1]:.4g} N s/m; {why}"
        out.append(near(f"{word}: damping", pairs[0][1] / pairs[1][1], 1.0, 0.15, COMMAND, note))
    return out


def _moments() -> list[Row]:
    """Gyroscopic moments at 15 000 and 40 000 r/min, 1 kN axial and 300 N radial, tilt free."""
    from raceway import build_model, make_plan, scene_from_dict
    from raceway.pipeline.settle import settle

    out = []
    for rpm in (15000.0, 40000.0):
        both = []
        for points in (4, None):
            made = {**tables(points, "free"), "load": {"axial": 1000.0, "radial": [300.0, 0.0]}}
            scene = scene_from_dict({**made, "kinematics": {"gyroscopic": "shared", "spin_speed_rpm": rpm}})
            both.append(settle(build_model(scene, make_plan(scene))))
        chosen = np.abs(both[1].displacement) > 1e-9
        moved = float(np.abs(both[0].displacement[chosen] / both[1].displacement[chosen] - 1.0).max())
        angle = float(np.degrees(np.abs(both[0].angle_inner - both[1].angle_inner).max()))
        word = f"gyroscopic moments, {rpm:g} r/min, 4 points against resultants"
        out.append(below(f"{word}: displacements", moved, 0.015, COMMAND, f"inner contact angles within {angle:.2f} deg"))
    return out


def _inertia() -> list[Row]:
    """What the balls' mass does to the dynamic stiffness, against K_ee - K_ep (K_pp - m w^2)^-1 K_pe of the static tangents."""
    from raceway import build_model, make_plan, scene_from_dict
    from raceway.pipeline.settle import settle

    out = []
    for rpm, within in ((12000.0, 2e-5), (50000.0, 2e-3)):
        changes = {
            "excitation": {"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": 200.0},
            "integrator": {"kind": "newmark", "turns": 4, "steps_per_turn": 90}, "contact": {"damping": 0.0},
        }  # fmt: skip
        made: dict[str, Any] = {**tables(3, "locked"), "load": {"axial": 1000.0}, "rotor": {"mass": 2.0}}
        for name, table in changes.items():
            made[name] = {**made.get(name, {}), **table}
        scene = scene_from_dict(made)
        stiffness = []
        for mass in (None, 0.0):
            model = build_model(scene, make_plan(scene))
            if mass is not None:
                model = attrs.evolve(model, system=attrs.evolve(model.system, ball_mass=mass))
            stiffness.append(_dynamic_stiffness(model))
        found = stiffness[0] / stiffness[1] - 1.0
        rest = settle(model)
        system: Any = build_model(scene, make_plan(scene)).system
        system.evaluate(rest.displacement, ball=rest.ball)
        row = system.pool.row(system.table)
        _, jacobian, _ = system._groove(rest.displacement, np.zeros(5), 0.0)
        still = row.balls.smoothed_stiffness(row.last, row.centre, row.where)
        speed = 2.0 * np.pi * rpm / 60.0
        moving = attrs.evolve(
            still, ball_stiffness=still.ball_stiffness - system.ball_mass * speed**2 * np.eye(len(still.ball_stiffness))
        )
        both = [float((jacobian.T @ row.balls.tangent(one) @ jacobian)[1, 1]) for one in (still, moving)]
        expected = both[1] / both[0] - 1.0
        note = "change of the dynamic stiffness by the balls' mass; linear theory with tangents at rest, 3 points"
        out.append(Row(
            f"{rpm:g} r/min: change by the balls' inertia in motion, expected {expected:.3g}", found,
            f"within {within:g}", abs(found - expected) <= within, COMMAND, note,
        ))  # fmt: skip
    return out


def _dynamic_stiffness(model: Any) -> float:
    from raceway.pipeline.settle import settle
    from raceway.pipeline.simulate import simulate

    equilibrium = settle(model)
    motion = simulate(model, equilibrium, lambda what, done, total: None)
    found = model.scene.identifier.method.identify([motion.record], equilibrium, model)
    return float(found.equivalent_stiffness)
