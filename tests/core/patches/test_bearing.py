"""Whole bearings on coarse patches: equilibrium, tangents, widening, edges, reports, and what is refused."""

from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from raceway import ConvergenceError, SceneError, make_plan, scene_from_dict
from raceway.core.fem.patches.balls import Balls
from raceway.core.fem.patches.system import Pool
from raceway.extend import CAGE, compiled, layout, surrogate
from raceway.testing import b7206c, model_of, run, settled

NODAL = b7206c(
    bodies={"kind": "condensed"}, contact={"kind": "unilateral", "discretisation": "nodal"},
    mesh={"kind": "structured", "nodes_per_semi_axis": 3, "element_size": 1.2e-3}, load={"radial": [500.0, 0.0]},
)  # fmt: skip
RESULTANT = {"kind": "hertz", "discretisation": "resultant"}


def tables(**more):
    return NODAL | {name: NODAL.get(name, {}) | table for name, table in more.items()}


def at_rest(**more):
    return settled(tables(**more))


@pytest.fixture(scope="module")
def free():
    return at_rest(supports={"tilt": "free"})


def off_tangent(system, at, ball):
    """Largest difference of the stiffness from differences of forces, each row and column by the root of its diagonal."""
    stiffness, worst = system.evaluate(at, ball=ball).stiffness, 0.0
    for j, size in enumerate([1e-11, 1e-11, 1e-11, 1e-9, 1e-9]):
        step = size * np.eye(5)[j]
        ahead, behind = (system.evaluate(at + s * step, ball=ball).force for s in (1.0, -1.0))
        weight = np.sqrt(np.diag(stiffness) * stiffness[j, j])
        worst = max(worst, np.abs(((ahead - behind) / (2.0 * size) - stiffness[:, j]) / weight).max())
    return worst


def test_ring_and_balls_are_in_equilibrium(free):
    case, found = free
    now = case.system.evaluate(found.displacement, ball=found.ball)
    # The tolerance of the iteration, 1e-11 of all forces.
    assert now.force[:3] == pytest.approx([1000.0, 500.0, 0.0], abs=1e-6)
    assert now.force[3:] == pytest.approx([0.0, 0.0], abs=1e-8)
    # Without centrifugal forces both races carry the same.
    assert found.contact_force[:12] == pytest.approx(found.contact_force[12:], rel=1e-9)
    # Both approaches of a ball are the grooves'; it lies less than 1 nm beside the line of their centres.
    offsets = case.system.scalars[[layout.OFFSET_INNER, layout.OFFSET_OUTER]].sum()
    grooves = np.linalg.norm(case.system.centre_vectors(found.displacement)[0], axis=1)
    assert now.gap.reshape(2, 12).sum(axis=0) == pytest.approx(offsets - grooves, abs=1e-9)
    # It is stepped from Python, and a compiled ring is near it.
    assert compiled(case.system) is None and compiled(surrogate(case.system)) is not None


def test_it_is_near_resultants_of_the_same_bodies(free):
    """2 % with three points along a semi-axis (0.8 % with eight); the mean stiffness 2 %."""
    case, found = free
    near = at_rest(contact=RESULTANT, supports={"tilt": "free"}, mesh={"element_size": 0.8e-3})[1]
    scale = np.array([1.0, 1.0, 1.0, case.system.arm, case.system.arm])
    assert np.abs((found.displacement - near.displacement) * scale).max() < 0.02 * np.abs(near.displacement * scale).max()
    assert np.diag(found.stiffness) == pytest.approx(np.diag(near.stiffness), rel=0.02)
    assert found.contact_force == pytest.approx(near.contact_force, rel=0.02)


def test_the_tangent_is_the_derivative(free):
    """Inside a step that changes no set of points; balls follow, so their places are part of it."""
    case, found = free
    # Forces are known to 1e-8 N here: 1e-3 of what 1e-11 m change.
    assert off_tangent(case.system, found.displacement, found.ball) < 3e-3
    now = case.system.evaluate(found.displacement, ball=found.ball)
    assert np.abs(now.stiffness - now.stiffness.T).max() < 1e-9 * np.abs(now.stiffness).max()


def test_dashpots_resist_the_ring_by_half_of_theirs_in_series(free):
    """Balls follow the ring by half: the dashpots c of both contacts in series, normal to them; 3 % of a stiffer race's share."""
    case, found = free
    scalars = case.system.scalars.copy()
    scalars[layout.DAMPING] = 50.0
    damped, v = attrs.evolve(case.system, scalars=scalars), np.array([2e-3, -1e-3, 1e-3, 0.0, 0.0])
    still, moving = (damped.evaluate(found.displacement, rate, found.ball) for rate in (0.0 * v, v))
    azimuth, angle = np.radians(30.0 * np.arange(12)), found.angle_inner
    closing = v[0] * np.sin(angle) + (v[1] * np.cos(azimuth) + v[2] * np.sin(azimuth)) * np.cos(angle)
    power = 25.0 * closing @ closing
    assert [v @ (moving.force - still.force), v @ moving.damping @ v] == pytest.approx([power, power], rel=0.03)


def test_a_state_does_not_depend_on_the_states_before(free):
    case, found = free
    before = case.system.evaluate(found.displacement, ball=found.ball)
    case.system.evaluate(found.displacement + np.array([2e-6, -1e-6, 1e-6, 0.0, 0.0]))
    after = case.system.evaluate(found.displacement)
    # Balls to 1e-11 of their forces.
    assert after.force == pytest.approx(before.force, abs=1e-6)


def test_balls_go_along_with_their_grooves_before_newton(free, monkeypatch):
    """A linearisation leaves a tenth at most of what the balls move within a tenth of a micrometre."""
    case, found = free
    seen, settle_balls = [], Balls.solve_equilibrium

    def watched(self, centre, where, *rest):
        place = settle_balls(self, centre, where, *rest)
        seen.append((where, place[0]))
        return place

    monkeypatch.setattr(Balls, "solve_equilibrium", watched)
    for axial in (0.0, 1e-7):
        case.system.evaluate(found.displacement + np.array([axial, 0.0, 0.0, 0.0, 0.0]), ball=found.ball)
    (_, before), (guess, after) = seen[0], seen[-1]
    assert np.abs(after - before).max() > 1e-8
    assert np.abs(after - guess).max() < 0.1 * np.abs(after - before).max()


@pytest.mark.slow
def test_balls_at_cage_speed_press_the_outer_race():
    case, found = at_rest(excitation={"kind": "bidirectional", "speed_rpm": 12e3, "amplitude": "constant", "force": 300.0})
    radial = np.cos(found.angle_outer) * found.contact_force[12:] - np.cos(found.angle_inner) * found.contact_force[:12]
    # A pressure over points leans by some hundredths of a degree against the line through ball and groove centre.
    assert radial == pytest.approx(case.system.table[:, layout.CENTRIFUGAL], rel=0.02)
    assert radial.min() > 10.0


def test_the_first_points_hold_the_contacts_of_the_scene_and_get_more_where_they_do_not(free):
    """Patches that are too small would be made again, wider, at several times the cost; three times the load needs it."""
    assert len(free[0].system.pool.generations) == 1
    turning = {"kind": "bidirectional", "speed_rpm": 60000.0, "unbalance": 1e-7}
    light, _ = at_rest(mesh={"nodes_per_semi_axis": 2}, load={"axial": 100.0, "radial": [0.0, 0.0]}, excitation=turning)
    assert len(light.system.pool.generations) == 1, "balls press the outer race alone"
    case = model_of(tables(mesh={"nodes_per_semi_axis": 2}))
    heavy = attrs.evolve(case.system, load=3.0 * case.system.load)
    rows = heavy.pool.patches[0].columns
    q, ball, _ = heavy.solve_equilibrium(case.guess)
    assert heavy.pool.patches[0].columns > rows
    assert heavy.evaluate(q, ball=ball).force[:2] == pytest.approx([3000.0, 1500.0], abs=1e-5)


def test_without_more_points_it_is_a_failure_that_says_where(free):
    case, _ = free
    alone = attrs.evolve(case.system, pool=Pool(model_of(tables()).bearing.pool.patches), load=16.0 * case.system.load)
    with pytest.raises(ConvergenceError, match="exceeds its patch of surface points along"):
        alone.solve_equilibrium(case.guess)


@pytest.mark.slow
def test_the_edge_of_the_groove_is_told_with_the_load():
    case, found = at_rest(bearing={"shoulder_height": 0.9e-3}, load={"axial": 3000.0, "radial": [0.0, 0.0]})
    said = case.bearing.warnings(case, found)
    assert any("truncated by the groove's edge" in one and "N per ball" in one for one in said)


def test_the_result_tells_pressures_approaches_and_points(free):
    result = run(scene_from_dict(tables(supports={"tilt": "free"})))
    ball = result.to_dict()["equilibrium"]["balls"][0]
    nodal, hertz = ball["peak_pressure_nodal_inner_pa"], ball["peak_pressure_inner_pa"]
    assert nodal == pytest.approx(hertz, rel=0.03)
    parts = [ball[f"approach_{part}inner_m"] for part in ("", "hertz_", "penetration_", "structural_")]
    assert parts[0] == pytest.approx(sum(parts[1:]), rel=1e-12)
    assert parts[2] == 0.0
    # Rings on rigid seats give less than half-spaces do.
    assert parts[3] < 0.0
    assert result.bodies["mesh"]["least_nodes_per_semi_axis"] > 2.0
    assert result.bodies["elasticity"][0][0] > 0.02
    case, found = free
    field = case.bearing.pressure_field(case, found, 0)
    assert field.pressure.max() == pytest.approx(nodal, rel=1e-6)
    assert case.system.without(CAGE).pool is case.system.pool


def test_the_error_of_the_contacts_is_the_share_that_overlaps(free):
    size, how = free[0].bearing.contact_error(*free)
    assert size == 0.0 and "overlap" in how, "unilateral"
    case, found = at_rest(contact={"kind": "hertz"}, supports={"tilt": "free"})
    size, how = case.bearing.contact_error(case, found)
    # 1 % of Hertz's approach at the typical load; it grows with the cube root of the load over its area, and contacts on
    # finite rings approach less than half-spaces: some percent.
    assert 0.005 < size < 0.03 and "not part of the total" in how
    columns = case.bearing.ball_columns(case, found)
    assert size >= (columns["approach_penetration_inner_m"] / columns["approach_inner_m"])[0]


def test_the_mesh_error_is_near_what_half_as_many_points_more_change(free):
    """Of order 2: 9/5 of that; within a factor of 3, for two points per semi-axis are not yet in the limit."""
    (coarse, found), (_, other) = at_rest(supports={"tilt": "free"}, mesh={"nodes_per_semi_axis": 2}), free
    weight = np.array([1.0, 1.0, 1.0, coarse.system.arm, coarse.system.arm])
    moved = np.abs((other.displacement - found.displacement) * weight).max()
    change = moved / np.abs(found.displacement * weight).max()
    assert 1.0 / 3.0 < coarse.bearing.mesh_error(coarse, found)[0] / change < 3.0


def test_the_mesh_error_is_that_of_the_state(free, monkeypatch):
    """Each state is dropped before the next, so that its place in memory is used again."""
    case, _ = free
    compared = staticmethod(lambda coarser, model, equilibrium: (float(equilibrium.displacement[0]), ""))
    monkeypatch.setattr(type(case.bearing), "_compared", compared)
    parts = (1.0, 0.2, 0.05)
    told = [case.bearing._change_from_coarser(case, SimpleNamespace(displacement=np.full(5, part)))[0] for part in parts]
    assert told == list(parts)


REFUSED = {
    "memory": ({"mesh": {"nodes_per_semi_axis": 60}}, "mesh.nodes_per_semi_axis", "use fewer points"),
    "elements": ({"mesh": {"element_size": 1e-5}}, "mesh.element_size", "use larger elements"),
    "a law of pairs only": ({"contact": {"kind": "unilateral", "discretisation": "resultant"}}, "contact.discretisation", "'nodal'"),
    "many steps": (
        {"excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 300.0},
         "rotor": {"mass": 2.0}, "integrator": {"kind": "central_difference"}},
        "integrator.kind", "quasi_static",
    ),
    "rigid bodies": ({"bodies": {"kind": "rigid"}}, "contact.discretisation", "rigid bodies have no surface points"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused_with_the_way_out(name):
    more, path, said = REFUSED[name]
    with pytest.raises(SceneError) as caught:
        make_plan(scene_from_dict(tables(**more)))
    assert any(m.path == path and said in m.message for m in caught.value.mistakes), str(caught.value)
