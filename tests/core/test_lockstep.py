"""Four points in lockstep: what the trust region finds for each alone, of which it is the readable reference."""

import numpy as np
import pytest

import raceway as rw
from raceway.bodies import columns
from raceway.core.ring.equilibria import equilibria
from raceway.core.ring.lockstep import POINT_ROWS, WORK_ROWS, lockstep
from raceway.core.signatures import States
from raceway.extend import layout

LOADS = {"load.axial": (5.0, 3000.0), "load.radial[0]": (-800.0, 500.0), "load.radial[1]": (-100.0, 100.0)}
SPEED = {"kinematics.spin_speed_rpm": (10.0, 40_000.0)}
TURNING = {"spin_speed_rpm": 9000.0}
CONDENSED = {
    "bodies": {"kind": "condensed"},
    "mesh": {"kind": "structured", "element_size": 2.5e-3, "nodes_per_semi_axis": 1},
}
SCENES = {
    "plain": ({"kinematics": TURNING | {"gyroscopic": "none"}}, LOADS | SPEED),
    "balls without mass": ({"kinematics": TURNING | {"ball_inertia": False}}, LOADS),
    "moments carried by traction": ({"kinematics": TURNING}, LOADS | SPEED | {"load.moment[0]": (-3.0, 3.0)}),
    "moments shared": ({"kinematics": TURNING | {"gyroscopic": "shared"}, "supports": {"tilt": 2e4}}, LOADS | SPEED),
    "a pair that external loads relieve": (
        {"bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 120.0}, "kinematics": TURNING},
        {"load.axial": (-600.0, 600.0), "load.radial[1]": (-500.0, 500.0)} | SPEED,
    ),
    "steep and fast": (
        {"bearing": {"preset": "7014C"}, "kinematics": TURNING | {"gyroscopic": "none"}, "supports": {"tilt": "locked"}},
        LOADS | {"kinematics.spin_speed_rpm": (10.0, 60_000.0), "bearing.contact_angle_deg": (5.0, 40.0)},
    ),
    "tandem": (
        {"bearing": {"preset": "B7206C", "arrangement": "DT", "ball_count": 7}, "kinematics": TURNING, "supports": {"tilt": "locked"}},
        LOADS | SPEED,
    ),
    "penalty, dashpots": (
        {"kinematics": TURNING, "contact": {"kind": "penalty", "time_constant": 1e-6}, "bearing": {"preset": "B7206C", "ball_count": 3}},
        LOADS | SPEED,
    ),
    "condensed": (CONDENSED | {"kinematics": TURNING | {"gyroscopic": "none"}}, LOADS | SPEED),
    "condensed, balls without mass": (CONDENSED | {"kinematics": TURNING | {"ball_inertia": False}}, LOADS),
    "condensed, moments": (CONDENSED | {"kinematics": TURNING, "supports": {"tilt": "locked"}}, LOADS | SPEED),
    "condensed, a pair with dashpots": (
        CONDENSED | {
            "bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 120.0}, "contact": {"kind": "penalty", "damping": 50.0},
            "kinematics": TURNING | {"gyroscopic": "shared"},
        },
        {"load.axial": (-600.0, 600.0), "load.radial[1]": (-500.0, 500.0)} | SPEED,
    ),
}  # fmt: skip


@pytest.fixture(params=SCENES)
def loop(request, monkeypatch):
    """The name of a scene, and the arguments of the largest loop over 97 of its points: 24 blocks, and one alone."""
    (scene, ranges), calls, rng = SCENES[request.param], [], np.random.default_rng(5)
    monkeypatch.setattr(columns, "equilibria", lambda *args: (calls.append(args), equilibria(*args)))
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 100.0}, "supports": {"tilt": "free"}} | scene
    rw.function(scene, ranges, ["stiffness", "damping"])(*(rng.uniform(*ends, size=97) for ends in ranges.values()))
    return request.param, *max(calls, key=lambda args: args[2].table.size)


def solved(kernels, linear, points, like):
    states = States(*(np.full_like(part, -7) for part in like))
    equilibria(kernels, linear, points, states)
    return states


def test_each_point_is_where_it_balances_alone(loop):
    """A residual of 1e-12 is 1e-9 of K where soft tilts multiply it."""
    name, kernels, linear, points, states = loop
    assert kernels.lanes
    alone, together = (solved(kernels._replace(lanes=lanes), linear, points, states) for lanes in (False, True))
    np.testing.assert_array_equal(together.status, alone.status)
    balanced = alone.status == 0
    assert balanced.mean() > 0.9
    size = np.sqrt(np.abs(np.einsum("pii->pi", alone.stiffness)))
    K = (together.stiffness - alone.stiffness) / (size[:, :, None] * size[:, None, :])
    assert np.abs(K[balanced]).max() < 1e-9
    largest = alone.force.max(axis=1, keepdims=True)
    assert np.abs((together.force - alone.force) / largest)[balanced].max() < 1e-9
    # A ball that the inner race leaves alone lies anywhere on the outer one, or, without mass, midway.
    pressed = (alone.force[:, : alone.ball.shape[1]] > 1e-6 * largest) & balanced[:, None]
    pressed |= ("mass" in name) & balanced[:, None]
    assert np.abs(together.ball - alone.ball)[pressed].max() < 1e-12
    if "condensed" in name:  # structural approaches, a hundredth of the contacts', have last digits of the forces
        apart = np.abs(together.ball - alone.ball)[balanced, :, -2:]
        assert apart.max() < 1e-9 * np.abs(alone.ball[balanced, :, -2:]).max()
    damping, apart = alone.damping[balanced], together.damping[balanced] - alone.damping[balanced]
    assert np.abs(apart).max() <= 1e-9 * np.abs(damping).max()
    assert damping.any() == ("dashpots" in name)


def test_few_points_are_left_to_the_trust_region(loop):
    """Of ranges as wide as these at most one in twenty."""
    _, kernels, linear, points, like = loop
    width, states = 8 * points.table.shape[1], States(*(np.full_like(part, -7) for part in like))
    params, memory = np.empty((width, points.params.shape[2])), np.zeros((width, 0))
    bodies = np.empty((4 * layout.are_condensed(points.scalars[0]), points.scalars.shape[1]))
    for first in range(0, len(states.status), 4):
        work, of_points = np.zeros((WORK_ROWS, width)), np.zeros((POINT_ROWS, 4))
        lockstep(kernels.law, linear, first, points, states, params, memory, bodies, work, of_points)
    assert set(states.status) <= {0, -1}
    assert (states.status == 0).mean() > 0.95


def test_what_balances_without_hold_is_no_equilibrium(monkeypatch):
    """A shaft that pushes tilts on: straight under an axial load the ring balances, but falls at the least touch to where it is held."""
    calls, scene = (
        [],
        {"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}, "supports": {"tilt": 2e4}, "kinematics": TURNING},
    )
    monkeypatch.setattr(columns, "equilibria", lambda *args: (calls.append(args), equilibria(*args)))
    rw.function(scene, ["load.axial"], ["stiffness"])(np.linspace(100.0, 900.0, 4))
    kernels, linear, points, like = calls[-1]
    assert kernels.lanes
    states = solved(kernels, linear, points._replace(shaft=np.full(4, -1e4)), like)
    tangent = states.stiffness + np.diag([0.0, 0.0, 0.0, -1e4, -1e4])
    assert (np.linalg.eigvalsh(0.5 * (tangent + tangent.swapaxes(1, 2))) > 0.0).all()
