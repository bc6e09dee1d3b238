"""Steady orbits of four points in lockstep, against balls that are found in each sample, and extremes against dense samples."""

import numpy as np
import pytest

import raceway as rw
from raceway.bodies import columns
from raceway.core.periodic.extremes import force_extremes
from raceway.core.periodic.orbits import Orbits, orbits
from raceway.extend import layout

SCENE = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 500.0}, "supports": {"tilt": "free"},
    "rotor": {"mass": 1.5}, "kinematics": {"gyroscopic": "none"},
    "excitation": {"kind": "bidirectional", "unbalance": 3e-5, "speed_rpm": 9000.0},
}  # fmt: skip
CONDENSED = {
    "bodies": {"kind": "condensed"},
    "mesh": {"kind": "structured", "element_size": 2.5e-3, "nodes_per_semi_axis": 1},
}
RANGES = {"load.axial": (300.0, 2000.0), "excitation.unbalance": (1e-6, 6e-5), "excitation.speed_rpm": (3000.0, 15_000.0)}
CHANGES = {
    "turning": {},
    "moments": {"kinematics": {"gyroscopic": "traction"}, "excitation": SCENE["excitation"] | {"whirl": "backward"}},
    "a pair": {"bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}},
    "one direction": {"excitation": SCENE["excitation"] | {"kind": "unidirectional", "unbalance": 1e-5}, "supports": {"tilt": "locked"}},
    "side load": {"load": {"axial": 500.0, "radial": [40.0, -20.0]}, "rotor": {"mass": 1.5, "damping": 300.0}},
    "dashpots, moments": {"contact": {"damping": 60.0}, "kinematics": {"gyroscopic": "traction"}},
    "balls without mass, dashpots": {"contact": {"damping": 60.0}, "kinematics": {"ball_inertia": False}, "load": {"axial": 500.0, "radial": [150.0, 0.0]}},
    "condensed": CONDENSED | {"kinematics": {"gyroscopic": "traction"}, "load": {"axial": 500.0, "radial": [40.0, -20.0]}},
    "condensed, turning": CONDENSED | {"kinematics": {"gyroscopic": "shared"}},
    "condensed, dashpots": CONDENSED | {"contact": {"damping": 60.0}},
    "time constants": {"contact": {"time_constant": 5e-7}, "excitation": SCENE["excitation"] | {"whirl": "backward"}},
}  # fmt: skip


@pytest.fixture(params=CHANGES)
def loop(request, monkeypatch):
    """The arguments of the largest loop over 33 points: eight blocks, and one alone."""
    calls, rng = [], np.random.default_rng(5)
    monkeypatch.setattr(columns, "orbits", lambda *args: (calls.append(args), orbits(*args)))
    answer = rw.function(SCENE | CHANGES[request.param], RANGES, ["min_ball_load", "largest_multiplier"])
    answer(*(rng.uniform(*ends, size=33) for ends in RANGES.values()))
    return max(calls, key=lambda args: args[2].table.size)


def solved(loop, **changes) -> Orbits:
    kernels, linear, points, states, turning, near, out = loop
    answer = Orbits(*(np.zeros_like(part) for part in out))
    orbits(kernels._replace(**changes), linear, points, states, turning, near, answer)
    return answer


def test_lanes_have_the_motions_of_balls_that_are_found_in_each_sample(loop):
    """Steps end below 1e-11 of the motion; contact forces of a moderate one are some thousand times stiffer."""
    assert loop[0].lanes
    alone, together = solved(loop, lanes=False), solved(loop)
    np.testing.assert_array_equal(together.status, alone.status)
    np.testing.assert_array_equal(together.samples, alone.samples)
    fine = alone.status == 0
    assert fine.mean() > 0.9
    # Of elastic bodies kernels leave 1e-8 of the structural approaches in their tangents, which a disturbance sees.
    seen = 1e-6 if layout.are_condensed(loop[2].scalars[0]) else 1e-7
    for name, tolerance in (("line", 1e-9), ("mean", 1e-9), ("peak", 1e-7), ("least", 1e-7), ("transfer", seen)):
        a, b = getattr(alone, name)[fine], getattr(together, name)[fine]
        axes = tuple(range(1, a.ndim))
        assert np.all(np.abs(a - b).max(axis=axes) <= tolerance * np.abs(a).max(axis=axes)), name
    assert np.abs(together.change - alone.change)[fine].max() < 0.01 * seen
    assert np.all(together.error[fine] <= loop[4].tolerance)


def test_a_bound_of_contact_forces_is_above_the_largest(loop):
    """By Lebesgue's constant, below 5 of as many samples, of the largest one, which no polynomial exceeds as much."""
    exact, bound = solved(loop), solved((*loop[:-1], loop[-1]._replace(least=loop[-1].least[:, :0])))
    fine, z = exact.status == 0, exact.peak.shape[1] // 2
    for race in (slice(0, z), slice(z, 2 * z)):
        largest, most = exact.peak[fine, race].max(axis=1), bound.peak[fine, race].max(axis=1)
        assert (most >= largest).all() and (most <= 5.0 * largest).all()


def test_a_point_does_not_feel_the_lanes_beside_it(loop):
    kernels, linear, points, states, turning, near, out = loop
    together, backwards = solved(loop), Orbits(*(np.zeros_like(part) for part in out))
    count = len(out.status)

    def reversed_rows(part):
        rows = {name: value for name, value in part._asdict().items() if np.shape(value)[:1] == (count,)}
        return part._replace(**{name: value[::-1].copy() for name, value in rows.items()})

    orbits(kernels, linear, *map(reversed_rows, (points, states, turning)), near, backwards)
    size = np.abs(together.line).max(axis=1, keepdims=True)
    assert np.all(np.abs(backwards.line[::-1] - together.line) <= 1e-10 * size)


@pytest.mark.parametrize("spans", [1, 3])
def test_extremes_are_those_of_the_polynomial_through_the_samples(spans):
    """Of harmonics that the samples hold exactly: 4000 values come within 1e-6 of the top, and forces do not pull."""
    n, z, times = 16, 3, np.arange(12) / 12.0
    order = np.roll(np.arange(z), -1) if spans > 1 else np.arange(z)
    peak, least, turn = np.zeros(6), np.zeros(6), np.zeros((12, 6))

    def curve(race, ball, turns):
        angle = 2.0 * np.pi * (turns + (ball / z if spans > 1 else 0.0)) + race + (ball if spans == 1 else 0.0)
        return 1.0 + np.cos(angle) + 0.3 * np.cos(2.0 * angle + 1.0) - 0.1 * np.sin(3.0 * angle)

    columns_of = [(race, ball) for race in range(2) for ball in range(z)]
    force = np.stack([curve(race, ball, np.arange(n) / (n * spans)) for race, ball in columns_of], axis=1)
    force_extremes(force, order, spans, peak, least, turn)
    dense = np.stack([curve(race, ball, np.arange(4000) / 4000.0) for race, ball in columns_of], axis=1)
    np.testing.assert_allclose(peak, dense.max(axis=0), rtol=1e-5)
    assert np.all(peak >= dense.max(axis=0))
    np.testing.assert_allclose(least, np.maximum(dense.min(axis=0), 0.0), atol=1e-5)
    exact = np.stack([curve(race, ball, times) for race, ball in columns_of], axis=1)
    np.testing.assert_allclose(turn, np.maximum(exact, 0.0), atol=1e-12)
