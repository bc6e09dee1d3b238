"""Compiled explicit steps against steps from Python, and mass that is added to small elements for a larger step."""

import numpy as np
import pytest

from checks.validation.reference import elastic
from checks.validation.scenes import built_in
from raceway import SceneError
from raceway.core.fem.elastic.bearing import ElasticSystem
from raceway.extend import HexOperator, Schedule, ThreadPool, integrate, standstill
from raceway.testing import settled
from tests.core.test_elastic_scene import EXCITED, TINY, scene

CentralDifference = built_in("integrator", "central_difference")
STEEL = (2.12e11, 0.29, 7810.0)
#: Friction on rigid seats, with dashpots, a damped rotor and free tilts.
CASE = {
    "contact": {"friction": 0.1, "damping": 300.0}, "rotor": {"damping": 200.0, "transverse_inertia": 1e-4},
    "supports": {"tilt": 3000.0},
}  # fmt: skip


@pytest.fixture(scope="module")
def model():
    tables = TINY | EXCITED
    return settled(tables | {name: tables.get(name, {}) | table for name, table in CASE.items()})[0]


def moved(model, threads: int = 1, steps: int = 12):
    assembly = model.bearing.bearing.system.assembly
    kept, assembly.threads = assembly.threads, ThreadPool(threads)
    start = standstill(model.system, False)
    unknown = assembly.unknown  # all of them move, so that forces do more than cancel
    start.full_state["v"][:] = 0.1 * unknown * np.random.default_rng(2).standard_normal(len(unknown))
    try:
        return integrate(CentralDifference(), model.system, start, Schedule(2e-9, steps, 1, 6))
    finally:
        assembly.threads = kept


def arrays(record):
    names = ("displacement", "velocity", "gap", "contact_force", "ball")
    return {name: getattr(record, name) for name in names} | record.final.full_state | record.energies


def test_compiled_steps_are_those_from_python(model, monkeypatch):
    """Ten digits of what the parts of a force cancel to; some points touch, rub and are let go, most are left out."""
    found, shared = moved(model), moved(model, 2)
    monkeypatch.setattr(ElasticSystem, "explicit", lambda system, dt, where: None)
    wanted = moved(model)
    assert np.abs(wanted.final.full_state["friction"]).max() > 0.0
    for name, values in ((name, each) for name, each in arrays(wanted).items() if each.size):
        np.testing.assert_allclose(arrays(found)[name], values, rtol=0.0, atol=1e-10 * np.abs(values).max(), err_msg=name)
        assert np.array_equal(arrays(found)[name], arrays(shared)[name]), name
    for name in ("max_penetration_m", "peak_contact_force_n"):
        assert found.counts[name] == pytest.approx(wanted.counts[name], rel=1e-10)


def test_mass_is_added_to_small_elements_only():
    """A row of bricks of two thicknesses: those that are thin get the mass that their own step asks for, the others none."""
    points, cells = elastic.block((4e-3, 1e-3, 1e-3), (4, 1, 1))
    points[points[:, 0] > 2.5e-3, 0] -= 0.7e-3 * (points[points[:, 0] > 2.5e-3, 0] > 0.0)
    plain = HexOperator(points, cells, *STEEL)
    step = 1.5 * plain.stable_step()
    scaled = HexOperator(points, cells, *STEEL, least_step=step)
    own = np.array([HexOperator(points, cells[e : e + 1], *STEEL).stable_step() for e in range(len(cells))])
    np.testing.assert_allclose(scaled.mass_factors, np.maximum((step / own) ** 2, 1.0), rtol=1e-9)
    assert set(scaled.mass_factors == 1.0) == {True, False}
    # The sums of rows, which are looked at first, say that a thin one needs mass for its own step, too.
    assert (HexOperator(points, cells, *STEEL, least_step=0.95 * own.min()).mass_factors == 1.0).all()
    assert scaled.stable_step() == pytest.approx(step, rel=1e-9)
    np.testing.assert_allclose(scaled.lumped_mass() - plain.lumped_mass(), scaled.added_mass(), rtol=1e-12, atol=1e-20)
    u = 1e-6 * np.random.default_rng(0).standard_normal(points.shape)
    assert np.array_equal(scaled.internal_force(u), plain.internal_force(u))


def test_what_the_ring_gains_is_its_kinetic_energy(model):
    """At unit speed along each motion of the frame, node by node; the outer ring and balls have no part in it."""
    a = model.bearing.bearing.system.assembly
    kept, a.added_mass = a.added_mass, np.random.default_rng(1).random(a.nodes)
    try:
        gained = a.added_inertia()
        ring = a.bodies[0]
        away = ring.points - ring.frame.centre
        mass = a.added_mass[: len(away)]
        assert gained[1, 1] == pytest.approx(mass.sum(), rel=1e-12)
        assert gained[3, 3] == pytest.approx((mass * (away[:, 0] ** 2 + away[:, 2] ** 2)).sum(), rel=1e-12)
        assert gained[0, 3] == pytest.approx((mass * away[:, 2]).sum(), rel=1e-12)
    finally:
        a.added_mass = kept


@pytest.mark.parametrize(("tables", "words"), [
    ({"integrator": {"kind": "newmark", "least_step": 3e-9}}, "unknown key"),
    ({"integrator": {"kind": "central_difference", "least_step": "soon"}}, "must be a number"),
    ({"integrator": {"kind": "central_difference", "least_step": -1.0}}, "greater than 0"),
    ({"integrator": {"kind": "central_difference", "least_step": 1e-3}}, "contacts"),
    ({"integrator": {"kind": "central_difference", "least_step": 3e-9}, "bodies": {"kind": "condensed"}}, "elastic"),
])  # fmt: skip
def test_a_least_step_that_cannot_be_is_refused(tables, words):
    from raceway import make_plan

    with pytest.raises(SceneError, match=rf"integrator\.least_step.*{words}"):
        make_plan(scene(**EXCITED, **tables))
