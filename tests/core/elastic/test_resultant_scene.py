"""Elastic bodies with one calibrated force a contact, from a scene: coarse meshes run, balance, agree with condensed bodies."""

import json
from typing import Any

import numpy as np
import pytest

from raceway import RacewayError, make_plan, scene_from_dict
from raceway.testing import b7206c, run, settled
from tests.core.test_elastic_scene import EXCITED

#: Three balls on 864 hexahedra: every path, some accuracy.
TINY: dict[str, Any] = b7206c(
    bearing={"ball_count": 3}, bodies={"kind": "elastic", "formulation": "incompatible"},
    mesh={"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 12},
    rotor={"mass": 0.5}, contact={"kind": "hertz"},
)  # fmt: skip


def scene(**tables):
    return scene_from_dict(TINY | {name: TINY.get(name, {}) | table for name, table in tables.items()})


@pytest.fixture(scope="module")
def static():
    return run(scene(load={"radial": [100.0, 0.0]}))


@pytest.fixture(scope="module")
def free():
    """A model whose ring may do what it likes, and its equilibrium under loads in all directions."""
    return settled(TINY | {"load": {"axial": 1000.0, "radial": [60.0, 20.0]}, "supports": {"tilt": "free"}})


def test_a_static_scene_balances_and_tells_what_it_took_off(static):
    found = static.to_dict()
    json.dumps(found, allow_nan=False)
    model, mesh = found["model"], found["model"]["mesh"]
    # Newton's residual is 1e-7 of the forces.
    assert model["reaction_n"]["x"] == pytest.approx(-1000.0, rel=1e-6)
    assert model["reaction_n"]["y"] == pytest.approx(-100.0, rel=1e-5)
    assert model["unbalanced_n"] < 1e-3
    assert "resultants calibrated to Hertz" in model["bodies"]
    assert mesh["cells"] == 864 and mesh["hourglass_coefficient"] is None
    # A tenth to half of what a Hertz contact gives at some 1000 N per ball, 8 nm/N.
    for key in ("replaced_inner_m_per_n", "replaced_outer_m_per_n"):
        assert 1e-9 < mesh[key] < 5e-9
    assert 0.0 < mesh["replaced_spread_m_per_n"] < 0.2 * mesh["replaced_inner_m_per_n"]
    assert 0.0 < mesh["replaced_uncertainty"] < 0.05
    assert 0.0 < mesh["largest_turn_deg"] < 3.0
    assert model["energies_j"]["elastic"] > 0.0 and model["energies_j"]["contact"] > 0.0
    plan = make_plan(scene())
    assert plan.dofs > 2_000 and "pressures at surface points" in {part.part for part in plan.left_out}
    unsure = [text for text in found["warnings"] if "too coarse to determine its compliance" in text]
    assert len(unsure) == (mesh["replaced_uncertainty"] > 0.0125)


def test_each_ball_carries_the_same_to_both_rings_along_its_line(static):
    found, equilibrium = static.to_dict()["equilibrium"], static.equilibrium
    balls = found["balls"]
    for ball in balls:
        # Balls without centrifugal force; the ball's middle, where both forces act, is in balance: the residual.
        assert ball["load_inner_n"] == pytest.approx(ball["load_outer_n"], rel=1e-5)
    assert balls[0]["load_inner_n"] > 1.05 * balls[1]["load_inner_n"]  # the radial load is towards the first one
    pushed = sum(b["load_inner_n"] * np.sin(np.radians(b["contact_angle_inner_deg"])) for b in balls)
    # Forces act along the line from the moved ball to the moved groove centre; angles are those of the rigid frames.
    assert pushed == pytest.approx(1000.0, rel=0.01)
    # The law keeps Hertz's approach for itself.
    hertz = [b[f"approach_hertz_{race}_m"] for race in ("inner", "outer") for b in balls]
    np.testing.assert_allclose(-equilibrium.gap, hertz, rtol=1e-9)  # 1e-12 of the gap, over what is left of the compliance
    for ball in balls:
        taken = ball["approach_replaced_inner_m"]
        assert 0.1 < taken / ball["approach_hertz_inner_m"] < 0.5
        # Finite bodies: the approach lies within a fifth of Hertz's, which the mesh alone would miss by what is taken off.
        assert ball["approach_inner_m"] == pytest.approx(ball["approach_hertz_inner_m"], rel=0.2)


def test_the_tangent_is_the_difference_of_the_loads(free):
    model, equilibrium = free
    system, load = model.system, model.system.load.copy()
    arm = np.array([1.0, 1.0, 1.0, 20.0, 20.0])  # tilts [rad] to displacements of a groove of 20 mm radius, per 1/m
    start = system.equilibrium
    stiffness = equilibrium.stiffness
    assert np.abs(stiffness - stiffness.T).max() == 0.0
    assert np.linalg.eigvalsh(stiffness * np.outer(arm, arm)).min() > 0.0
    for k in range(5):
        step = np.eye(5)[k] * (1.0 if k < 3 else 0.01)
        ahead, behind = (system.equilibrium_under(start, load + sign * step, 1e-9)[0][:5] for sign in (1.0, -1.0))
        found = stiffness @ (ahead - behind) / 2.0
        # Loads change by 1e-3 and 2e-2 of themselves: their square; equilibria to 1e-9 of 1000 N over 1 N: 1e-6.
        np.testing.assert_allclose(found * arm, step * arm, atol=5e-5 * step[k] * arm[k])


def test_energy_grows_by_the_work_of_the_loads(free):
    model, _ = free
    system, bodies = model.system, model.system.bodies.system
    start, load = system.equilibrium, model.system.load.copy()
    step = np.array([50.0, 10.0, -5.0, 0.1, 0.1])
    ends = [system.equilibrium_under(start, load + sign * step, 1e-9)[0] for sign in (1.0, -1.0)]
    stored = []
    for y in ends:
        system.in_place(y)
        energies = bodies.energies(y, np.zeros_like(y))
        stored.append(energies["elastic"] + energies["contact"])
    work = float(load @ (ends[0][:5] - ends[1][:5]))
    # A difference of two equilibria: right to the second order, so wrong by some (50 N / 1000 N)^2.
    assert stored[0] - stored[1] == pytest.approx(work, rel=2.5e-3)
    assert work > 0.01 * stored[1]


def test_a_coarse_mesh_gives_what_condensed_bodies_give():
    article = b7206c(supports={"tilt": "locked"}, rotor={"mass": 2.0}, load={"radial": [500.0, 0.0]})
    mesh = {**TINY["mesh"], "azimuth_cells": 24}
    coarse = run(scene_from_dict({**article, "bodies": TINY["bodies"], "mesh": mesh}))
    condensed = run(scene_from_dict({**article, "bodies": {"kind": "condensed"}}))
    assert coarse.to_dict()["model"]["mesh"]["cells"] < 3000
    ratio = coarse.equilibrium.displacement[:2] / condensed.equilibrium.displacement[:2]
    stiffness = np.diag(coarse.equilibrium.stiffness) / np.diag(condensed.equilibrium.stiffness)
    # What is taken off is known to 1 % of a contact's compliance (``replaced_uncertainty``), and both are calibrated on contacts at
    # surface points.  Deliberate fault: without ``- beyond[...]`` in ``resultant_contact`` kyy is 1.3 % too stiff.
    np.testing.assert_allclose(ratio, 1.0, atol=0.01)
    np.testing.assert_allclose(stiffness, 1.0, atol=0.01)
    told = coarse.to_dict()
    mesh = told["model"]["mesh"]
    # What contacts at surface points have beyond depth matching: some 1 % of a contact's 6 to 8 nm/N.
    assert all(0.02e-9 < mesh[f"calibration_{race}_m_per_n"] < 0.2e-9 for race in ("inner", "outer"))
    # What the calibration and the mesh leave is stated, and is no total: how the mesh bends is not known.
    assert np.abs(stiffness - 1.0).max() < told["error"]["contact"] < 0.05
    assert "surface points" in told["error"]["how"]["contact"] and told["error"]["total"] is None
    # Loads of the balls decide little: one by one within the same bound of the largest.
    apart = np.abs(coarse.equilibrium.contact_force - condensed.equilibrium.contact_force).max()
    assert apart < 0.015 * condensed.equilibrium.contact_force.max()


def test_a_series_of_equilibria_gives_the_tangents_stiffness():
    step = {"kind": "quasi_static", "turns": 1, "steps_per_turn": 8, "tolerance": 1e-6}
    series = run(scene(**EXCITED, integrator=step)).to_dict()["identification"]["equivalent_stiffness"]
    tangent = run(scene(**EXCITED, identifier={"kind": "tangent"})).to_dict()["identification"]["equivalent_stiffness"]
    # 300 N of the 1000 N that each of three balls carries: a few percent of curvature.
    assert series == pytest.approx(tangent, rel=0.05)


REFUSED = [
    ({"contact": {"friction": 0.1}}, "contact.friction", "set it 0, use 'nodal'"),
    ({"contact": {"kind": "penalty", "discretisation": "nodal"}}, "mesh.nodes_per_semi_axis", "use at least 1, or"),
    ({"bodies": {"kind": "condensed"}}, "mesh.nodes_per_semi_axis", "sections of condensed bodies need cells"),
    ({"contact": {"kind": "unilateral"}}, "contact.discretisation", "law 'unilateral' supports 'nodal'"),
    ({"kinematics": {"orbiting": True, "spin_speed_rpm": 1e4}}, "kinematics.orbiting", "azimuth"),
    ({"mesh": {"element_size": 8e-3}}, "mesh.element_size", "larger than the wall"),
    ({**EXCITED, "integrator": {"kind": "periodic"}}, "integrator.kind", "Use 'newmark'"),
    ({"contact": {"kind": "penalty", "stiffness": 1e18}}, "contact.kind", "stiffer than the mesh below it"),
    ({"load": {"axial": 0.0, "radial": [200.0, 0.0]}}, "", "no stiffness against z"),
]


@pytest.mark.parametrize(("change", "path", "why"), REFUSED, ids=[f"{path}-{why[:12]}" for _, path, why in REFUSED])
def test_what_whole_contacts_cannot_do_is_refused_with_the_way_out(change, path, why):
    with pytest.raises(RacewayError, match=why) as caught:
        run(scene(**change))
    assert not path or path in {mistake.path for mistake in caught.value.mistakes}
