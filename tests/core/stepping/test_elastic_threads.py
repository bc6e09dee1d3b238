"""Explicit steps of elastic bodies by several threads, and the forces of a step against readable sums."""

import threading
from functools import cache

import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import StabilityError
from raceway.core.fem.elastic.body_forces import threads_for
from raceway.extend import Schedule, ThreadPool, integrate, standstill
from raceway.testing import settled
from tests.core.test_elastic_scene import EXCITED, TINY

CentralDifference = built_in("integrator", "central_difference")

#: Friction on rigid seats; dashpots, a shaft and elastic seats, whose ring rides on its bed, with the other element.
CASES = {
    "friction": {"contact": {"friction": 0.1}},
    "seats": {
        "bodies": {"formulation": "incompatible"},
        "contact": {"damping": 300.0},
        "rotor": {"damping": 200.0, "transverse_inertia": 1e-4},
        "supports": {"inner_seat": 1e14, "outer_seat": 2e14, "tilt": 3000.0},
    },
}
STEPS, STEP = 6, 2e-9


@cache
def model_of(case: str):
    """Model and its equilibrium."""
    tables = TINY | EXCITED
    return settled(tables | {name: tables.get(name, {}) | table for name, table in CASES[case].items()})


def moved(case: str, threads: int, steps: int = STEPS, step: float = STEP, on_chunk=None):
    """Record of some steps after a sudden force, all of them recorded."""
    model, found = model_of(case)
    assembly = model.bearing.bearing.system.assembly
    kept, assembly.threads = assembly.threads, ThreadPool(threads)
    try:
        start = standstill(model.system, False)
        return integrate(CentralDifference(), model.system, start, Schedule(step, steps, 1), on_chunk)
    finally:
        assembly.threads = kept


@pytest.mark.parametrize("case", ["friction", pytest.param("seats", marks=pytest.mark.slow)])
def test_the_digits_do_not_depend_on_the_number_of_threads(case):
    alone = moved(case, 1)
    assert np.abs(alone.displacement[-1, 1:3]).max() > 0.0
    if case == "friction":
        assert np.abs(alone.final.full_state["friction"]).max() > 0.0
    for threads in (2, 3):
        found = moved(case, threads)
        assert found.counts["threads"] == threads
        names = ("displacement", "velocity", "gap", "contact_force", "ball")
        one, other = ({name: getattr(record, name) for name in names} for record in (alone, found))
        for name, values in (one | alone.final.full_state | alone.energies).items():
            assert np.array_equal((other | found.final.full_state | found.energies)[name], values), name


@pytest.mark.parametrize("case", CASES)
def test_forces_of_a_step_are_the_sums_of_their_parts(case):
    """Against matrices and whole nodal vectors, written out; bodies, cage, frame, seats and contacts at a random state."""
    model, found = model_of(case)
    system = model.bearing.bearing.system
    a, contact = system.assembly, system.contact
    rng = np.random.default_rng(4)
    y = model.system.equilibrium + 1e-8 * rng.standard_normal(a.size)
    v, dt = 1e-2 * rng.standard_normal(a.size), 1e-9
    ties = np.zeros((3 * a.nodes, a.size))
    ties[a.tied, : a.frame_size] = a.carried[a.tied]
    ties[a.free, a.frame_size + np.arange(len(a.free))] = 1.0
    u = ties @ y
    assert np.array_equal(a.nodal(y), u)
    parts = [body.operator.stiffness() @ u[a.part(k)] for k, body in enumerate(a.bodies)]
    force = np.concatenate(parts) + a.cage.rows.T @ (a.cage.stiffness * (a.cage.rows @ u))
    expected = np.zeros(a.size)
    for foundation, ride in a.foundations:
        pull = foundation @ (u - ride @ y[: a.frame_size])
        force += pull
        expected[: a.frame_size] -= ride.T @ pull
    force += contact.evaluate(dt, u, ties @ v)
    expected += ties.T @ force
    expected[: a.frame_size] += a.frame_stiffness @ y[: a.frame_size] + a.frame_damping @ v[: a.frame_size]
    with a.threads:
        told = system.internal(0.0, dt, y, v)
    # Forces of thousands of newtons an element cancel: rounding of stiffness times displacement.
    size = max(float(np.abs(part).max()) for part in parts)
    assert np.abs(told - expected).max() <= 1e-9 * size
    assert np.linalg.norm(told - expected) <= 1e-10 * np.linalg.norm(expected)


@pytest.mark.parametrize("case", CASES)
def test_accelerations_are_those_of_the_whole_matrices(case):
    """(M + c C)^-1 (outer - inner + c C a), in place of the inner forces."""
    model, _ = model_of(case)
    stepped, system = model.system.stepped(), model.bearing.bearing.system
    rng, c, m = np.random.default_rng(6), 1e-4, system.assembly.frame_size
    outer, inner, a = rng.standard_normal((3, stepped.size))
    damping = np.zeros((stepped.size, stepped.size))
    damping[:m, :m] = system.assembly.frame_damping
    right = outer - inner + c * damping @ a
    found = stepped.accelerations(outer, inner, a, c)
    assert found is inner
    back = system.mass_times(found) + c * damping @ found
    free = system.assembly.unknown
    assert np.abs(back - right)[free].max() <= 1e-13 * np.abs(right).max()
    assert (found[:m][~system.assembly.frame_free] == 0.0).all()
    if case == "seats":
        assert np.abs(damping).max() > 0.0
    # Hourglass energy of all bodies is the sum of theirs.
    a, u = system.assembly, 1e-7 * np.random.default_rng(5).standard_normal(3 * system.assembly.nodes)
    wanted = sum(body.operator.hourglass_energy(u[a.part(k)]) for k, body in enumerate(a.bodies))
    assert (wanted > 0.0) == (case == "friction")
    assert a.body_forces.hourglass_energy(u, a.threads) == pytest.approx(wanted, rel=1e-13)  # ranges in another order


def test_threads_live_over_a_run_and_end_with_it_also_where_it_fails():
    def names() -> set[str]:
        return {thread.name for thread in threading.enumerate() if thread.name.startswith("raceway")}

    seen = []
    moved("friction", 3, on_chunk=lambda done, total: seen.append(names()))
    assert len(seen) >= 1
    assert all(len(one) == 2 for one in seen)
    assert names() == set()
    with pytest.raises(StabilityError):
        moved("friction", 3, step=1.0)
    assert names() == set()


def test_small_bodies_are_stepped_by_one_thread(monkeypatch):
    monkeypatch.setattr("raceway.core.fem.elastic.body_forces.usable_cores", lambda: 16)
    assert threads_for(500) == 1
    assert 1 < threads_for(60_000) < 16
    assert threads_for(1_000_000) == 16
