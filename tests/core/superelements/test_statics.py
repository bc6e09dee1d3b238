"""Equilibria by superelements against the unreduced system: every node, iterated to eleven digits; linearised, put back into its equations."""

import gc
import weakref

import numpy as np
import pytest

import raceway as rw
from raceway.core.fem.elastic.interface import Motions
from raceway.core.fem.elastic.superelement import Closed, Loose
from raceway.core.fem.elastic.superelement_solver import BallTangent, LinearisedContacts
from tests.core.superelements.bearings import built, start_of, tiny, unreduced, with_node_moved
from tests.core.test_elastic_scene import scene as elastic_scene

#: Of Newton's residual over the forces that balance; the iterated solver needs some ten iterations to it.
TIGHT = 1e-11
SCENES = {
    "one_point": {},
    "incompatible": {"bodies": {"formulation": "incompatible"}},
    "free to tilt": {"supports": {"tilt": "free"}},
    "on beds": {"supports": {"inner_seat": 1e12, "outer_seat": 2e12, "tilt": "free"}},
    "four balls": {"bearing": {"ball_count": 4}, "mesh": {"azimuth_cells": 32}},
    # Four cells around for each ball: contacts may touch the cut planes, and rings are whole.
    "whole rings": {"mesh": {"azimuth_cells": 12}},
    "turning": {"excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "amplitude": "constant", "force": 300.0}},
}


#: Each that meets code of its own: beds let the tilts free, too.
QUICK = ("one_point", "whole rings")


@pytest.fixture(
    params=[pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in SCENES], scope="module"
)
def settled(request):
    """The system of a scene with its equilibrium, and that of the unreduced system with the contacts' forces there."""
    model = built(**SCENES[request.param])
    system, guess = model.bearing.bearing.system, start_of(model)
    plain = unreduced(system)
    there = plain.solve_equilibrium(guess, TIGHT).y
    forces = system.contact.resultants().copy()
    tangent = stiffness_by_differences(plain, there)
    found = system.solve_equilibrium(guess, TIGHT)
    return request.param, model, found, there, forces, tangent


def stiffness_by_differences(system, y):
    """(m, m) of the frame's free motions: by central differences of the unreduced equilibria, 0.01 N and 1e-4 N m to both sides."""
    chosen = np.flatnonzero(system.assembly.frame_free)
    kept, compliance = system.load.copy(), np.empty((len(chosen), len(chosen)))
    reach = np.array([1.0, 1.0, 1.0, 0.01, 0.01])[chosen]
    for column, motion in enumerate(chosen):
        step, moved = 1e-2 * reach[column], []
        for sign in (1.0, -1.0):
            system.load = kept.copy()
            system.load[motion] += sign * step
            moved.append(system.solve_equilibrium(y, TIGHT).y[chosen])
        compliance[:, column] = (moved[0] - moved[1]) / (2.0 * step)
    system.load = kept
    return np.linalg.inv(compliance)


def test_rings_are_sectors_unless_contacts_may_touch_their_cuts(settled):
    name, model, *_ = settled
    face = model.bearing.bearing.system.solver.interface(0.0)
    assert {type(ring.element) for ring in face.rings} == {Loose if name == "whole rings" else Closed}
    assert [members for _, members in face.groups] == [list(range(model.system.ball_count))]


def test_displacements_and_contact_forces_are_those_of_the_unreduced_system(settled):
    """1e-11 of the forces, times a softness of some hundred where rings are free to tilt."""
    _, model, found, there, forces, _ = settled
    system = model.bearing.bearing.system
    system.static_internal(found.y)
    assert np.abs(found.y - there).max() < 1e-8 * np.abs(there).max()
    assert np.abs(found.y[:5] - there[:5]).max() < 1e-8 * np.abs(there[:5]).max()
    assert np.abs(system.contact.resultants() - forces).max() < 1e-8 * np.abs(forces).max()


def test_all_forces_balance(settled):
    _, model, found, *_ = settled
    system = model.bearing.bearing.system
    rest = (system.load - system.static_internal(found.y)) * system.assembly.unknown
    assert system.measure(rest) < 1e-9 * system.force_scale()
    assert np.linalg.norm(rest[5:]) < 1e-9 * np.linalg.norm(system.contact.resultants(), axis=1).max()


def test_each_solution_adds_five_digits(settled):
    """Single precision, 1e-7, times a condition of a hundred; contacts are in balance after each, so nothing else is iterated."""
    _, _, found, *_ = settled
    for before, after in zip(found.residuals[:-1], found.residuals[1:], strict=True):
        assert after < max(1e-4 * before, 1e-11)
    assert found.iterations <= 3


def test_the_stiffness_of_the_ring_is_that_of_equilibria_nearby(settled):
    """Of the motions that are free in the scene: 1e-11 of the forces over differences of 8e-6 of them."""
    _, model, found, _, _, wanted = settled
    system = model.bearing.bearing.system
    system.static_internal(found.y)
    free = np.flatnonzero(system.assembly.frame_free)
    compliance = system.condensed.frame_compliance()[np.ix_(free, free)]
    scale = np.sqrt(np.diag(wanted))
    error = (np.linalg.inv(compliance) - wanted) / np.outer(scale, scale)
    assert np.abs(error).max() < 1e-5
    assert np.abs(compliance - compliance.T).max() < 1e-9 * np.abs(compliance).max()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "bodies", "groups"),
    [pytest.param("on beds", (0, 1), [[0, 1, 2]], marks=pytest.mark.slow), ("one_point", (3,), [[0, 2], [1]])],
    ids=["rings", "ball"],
)
def test_bodies_that_differ_in_the_tenth_digit_are_factored_by_themselves_and_give_the_same_answer(name, bodies, groups):
    """One node moved: a strain of 1e-10 of what a cell takes."""
    model, found = built(**SCENES[name]), []
    for part in (0.0, 1e-10):
        system = with_node_moved(model, bodies, part)
        found.append(system.solve_equilibrium(start_of(model), TIGHT).y)
        face = system.solver.interface(0.0)
        assert {type(ring.element) for ring in face.rings} == {Loose if part and 0 in bodies else Closed}
        assert [members for _, members in face.groups] == (groups if part else [[0, 1, 2]])
    assert np.abs(found[1] - found[0]).max() < 1e-8 * np.abs(found[0]).max()


#: Of springs of some 1e8 N/m on bodies of 1e-8 m/N: condition 1e4.
ROUNDING = 1e-9


@pytest.mark.parametrize("way", ["factored", "iterated"])
@pytest.mark.parametrize("held", [(), (3, 4), (1,)])
def test_forces_balance(way, held, monkeypatch):
    monkeypatch.setattr("raceway.core.fem.elastic.superelement_solver._FACTORED", 10**6 if way == "factored" else 0)
    system = tiny().bearing.bearing.system
    contact, assembly = system.contact, system.assembly
    face = system.condensed.interface(0.0)
    rng = np.random.default_rng(5)
    chosen = rng.permutation(len(contact.nodes))[: len(contact.nodes) // 3]
    nodes, weights = face.place[contact.nodes[chosen]], contact.weights[chosen]
    some = rng.standard_normal((len(chosen), 3, 3))
    blocks = 1e7 * (some @ some.transpose(0, 2, 1)) + 2e6 * rng.standard_normal((len(chosen), 3, 3))  # not symmetric
    ball = contact.pair[chosen] % face.ball_count
    tangents = {k: BallTangent.of(nodes[ball == k], weights[ball == k], blocks[ball == k]) for k in range(face.ball_count)}
    m = assembly.frame_size
    unknown = ~np.isin(np.arange(m), held)
    frame = 1e3 * np.eye(m)
    driver = Motions(
        1e-6 * rng.standard_normal((len(face.numbers), 3)), 1e-6 * rng.standard_normal((face.ball_count, face.extra)),
        rng.standard_normal(m),
    )  # fmt: skip
    force, q = LinearisedContacts(face, tangents, frame, unknown).forces(driver)
    back = face.moved(Motions(-force.nodes, -force.balls, q), q)
    x, mean = driver.nodes + back.nodes, driver.balls + back.balls
    wanted = np.zeros_like(x)
    moved = np.einsum("pa,pac->pc", weights, x[nodes])
    pressed = np.einsum("pcd,pd->pc", blocks, moved)
    for a in range(8):
        np.add.at(wanted, nodes[:, a], weights[:, a, None] * pressed)
    assert np.abs(force.nodes - wanted).max() < ROUNDING * np.abs(wanted).max()
    for k in range(face.ball_count):
        springs = face.springs(k, True)
        assert np.abs(force.balls[k] - springs * mean[k]).max() < ROUNDING * np.abs(springs * mean[k]).max()
    rest = (driver.frame - frame @ q - face.on_frame(wanted))[unknown]
    assert np.abs(rest).max(initial=0.0) < ROUNDING * np.abs(wanted).sum()
    assert not q[~unknown].any()


@pytest.mark.slow
def test_linearised_bearings_go_with_their_iteration():
    alive, most, plain = weakref.WeakSet(), [0], LinearisedContacts.__init__

    def counted(self, *given):
        alive.add(self)
        plain(self, *given)
        most[0] = max(most[0], len(alive))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("raceway.core.fem.elastic.superelement_solver._FACTORED", 0)
        patch.setattr(LinearisedContacts, "__init__", counted)
        gc.disable()
        try:
            rw.run(elastic_scene())
        finally:
            gc.enable()
    assert most[0] == 1
