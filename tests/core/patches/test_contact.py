"""Single contacts: Hertz, complementarity, tangents, laws at points, warm starts, ends of a patch."""

import attrs
import numpy as np
import pytest

import raceway as rw
from raceway import LAW, ConvergenceError, MeshError, jit
from raceway.core.contact.hertz import Ellipse
from raceway.core.fem.patches.compliance import ComplianceFactor
from raceway.core.fem.patches.patch import Spacing
from raceway.core.fem.patches.pressure import BeyondPatch, Contact, PointLaw, Reach
from raceway.core.fem.patches.system import Pool
from raceway.extend import three_halves
from raceway.testing import pressure_field
from tests.core.validation.single import Single, single


@pytest.fixture(scope="module")
def coarse() -> Single:
    """Three points along each semi-axis at 300 N."""
    return single(3, 300.0)


@jit(LAW)
def hardening(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """A third party's: p = k d (1 + d / h) with a dashpot c d."""
    for i in range(gap.size):
        d = max(-gap[i], 0.0)
        lag = max(1.0 - params[i, 2] * gap_rate[i], 0.0)
        force[i] = params[i, 0] * d * (1.0 + d / params[i, 1]) * lag
        d_gap[i] = -params[i, 0] * (1.0 + 2.0 * d / params[i, 1]) * lag if gap[i] < 0.0 else 0.0
        d_rate[i] = -params[i, 2] * params[i, 0] * d * (1.0 + d / params[i, 1]) if lag > 0.0 else 0.0


@jit(LAW)
def broken(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Not a number wherever it is asked."""
    for i in range(gap.size):
        force[i], d_gap[i], d_rate[i] = np.sqrt(-1.0 + 0.0 * gap[i]), -params[i, 0], 0.0


def linear(case: Single, share: float) -> PointLaw:
    """Pressure per gap whose penetration under the peak pressure at 300 N is a share of Hertz's approach."""
    stiffness = float(case.ellipse.peak_pressure(300.0)) / (share * float(case.ellipse.approach(300.0)))
    return PointLaw(three_halves, np.array([0.0, stiffness]), case.patch.area)


@pytest.mark.parametrize("load", [100.0, 1000.0])
def test_four_points_give_hertz_pressure(load):
    """1 %; 1.5 % at 1000 N, where the groove's torus is no paraboloid any more: its ellipse is 1.6 % shorter."""
    case = single(4, load)
    approach, pressed = case.at_load(load)
    assert case.peak(pressed) == pytest.approx(float(case.ellipse.peak_pressure(load)), rel=0.01 if load < 500.0 else 0.015)
    # The finite bodies take 0.8 nm/N off half-spaces' approach, whatever the load (docs/nodal_contact.md); 4 points add 0.1.
    assert 1e9 * (approach - float(case.ellipse.approach(load))) / load == pytest.approx(-0.85, abs=0.12)


def test_nothing_penetrates_and_nothing_pulls(coarse):
    approach, pressed = coarse.at_load(300.0)
    contact = Contact(coarse.patch, None)
    coarse.press(contact, approach)
    gap = contact._gap.reshape(-1)
    rest = gap + ComplianceFactor(coarse.patch).displacement(np.arange(len(gap)), pressed.nodes, pressed.load)
    assert pressed.load.min() > 0.0
    # Rounding of gaps that are differences of lengths a thousand times larger.
    assert np.abs(rest[pressed.nodes]).max() < 1e-9 * approach
    assert rest.min() > -1e-9 * approach
    opened = coarse.press(Contact(coarse.patch, None), -1e-6)
    assert not opened.force.any() and not opened.stiffness.any() and len(opened.nodes) == 0


@pytest.mark.parametrize("law", ["none", "linear", "hardening"])
def test_the_tangent_is_the_derivative(coarse, law):
    """While the points in contact stay the same, to the error of central differences."""
    laws = {
        "none": None, "linear": linear(coarse, 0.05),
        "hardening": PointLaw(hardening, np.array([linear(coarse, 0.05).params[1], 1e-6, 1e-3]), coarse.patch.area),
    }  # fmt: skip
    contact = Contact(coarse.patch, laws[law])
    place, step = coarse.place(5e-6, coarse.angle + 0.004), 1e-11
    now = contact.press(place, np.zeros(2))
    for k, way in enumerate(np.eye(2)):
        ahead, behind = (contact.press(place + s * step * way, np.zeros(2)) for s in (1.0, -1.0))
        assert np.array_equal(ahead.nodes, behind.nodes)
        found = (behind.force - ahead.force) / (2.0 * step)
        assert np.abs(found - now.stiffness[:, k]).max() < 1e-5 * np.abs(now.stiffness).max()
    if law == "hardening":
        rate = 0.1
        ahead, behind = (contact.press(place, np.array([s * rate, 0.0])) for s in (1.0, -1.0))
        found = (behind.force - ahead.force) / (2.0 * rate)
        assert np.abs(found - now.viscous[:, 0]).max() < 1e-5 * np.abs(now.viscous).max()


def test_a_single_point_carries_what_it_carries_among_others(coarse):
    law = linear(coarse, 0.05)
    alone = law(np.array([-1e-9]), np.zeros(1))
    among = law(np.array([-1e-9, -2e-9]), np.zeros(2))
    assert alone[0] > 0.0
    assert all(one[0] == two[0] for one, two in zip(alone, among, strict=True))


def test_the_mean_stiffness_is_the_mean_of_the_points_over_one_distance_of_rows(coarse):
    """The point tangent along the groove swings by percents, of which eight places see the mean to a tenth; the mean one does not."""
    contact = Contact(coarse.patch, None)
    pitch = coarse.patch.race.angle[1] - coarse.patch.race.angle[0]

    def stiffness(shift):
        place = coarse.place(5e-6, coarse.angle + shift * pitch)
        normal = place / np.hypot(*place)
        return [normal @ k @ normal for k in (contact.press(place, np.zeros(2)).stiffness, contact.mean_stiffness(place))]

    point, mean = np.ptp([stiffness(shift) for shift in np.linspace(-0.25, 0.25, 5)], axis=0) / stiffness(0.0)[1]
    assert mean < 0.01 and mean < 0.4 * point
    points = np.mean([stiffness((k + 0.5) / 8.0 - 0.5)[0] for k in range(8)])
    assert stiffness(0.0)[1] == pytest.approx(points, rel=0.01)
    # Along the groove the force turns with the ball: F / |x|, a hundredth of the stiffness across it; these points leave 4 %.
    place = coarse.place(5e-6)
    length, force = np.hypot(*place), np.hypot(*contact.press(place, np.zeros(2)).force)
    along = np.array([place[1], -place[0]]) / length
    assert along @ contact.mean_stiffness(place) @ along == pytest.approx(force / length, rel=0.07)


def test_a_softer_law_approaches_further_by_its_penetration(coarse):
    """At the peak the law's penetration joins the bodies' approach; the pressure falls a little."""
    hard, pressed = coarse.at_load(300.0)
    soft, other = coarse.at_load(300.0, linear(coarse, 0.01))
    assert other.penetration == pytest.approx(0.01 * float(coarse.ellipse.approach(300.0)), rel=0.05)
    # A pressure of mean 2/3 of the peak: 2/3 of the penetration, and what the wider ellipse gives back.
    assert 0.3 * other.penetration < soft - hard < 1.1 * other.penetration
    assert coarse.peak(other) == pytest.approx(coarse.peak(pressed), rel=0.02)


def test_a_contact_that_leaves_its_points_says_where(coarse):
    contact = Contact(coarse.patch, None)
    with pytest.raises(BeyondPatch, match=r"inner race, .* N at 2\d\.\d+ deg, exceeds .* along the groove"):
        coarse.press(contact, 5e-6, coarse.angle + 0.12)
    with pytest.raises(BeyondPatch, match="rolling direction"):
        coarse.press(contact, 30e-6)


def test_the_edge_of_the_groove_cuts_the_contact_off():
    """Near the edge the patch ends with the groove: rows that would lie beyond are missing, and the answer says so."""
    free = single(3, 300.0)
    edge = free.patch.race.edges[1]
    case = single(3, 300.0, angle=edge - 0.15)
    assert case.patch.race.ends[1]
    assert case.patch.race.angle[-1] < edge
    _, light = case.at_load(5.0)
    _, heavy = case.at_load(300.0)
    assert not light.truncated
    assert heavy.truncated
    # Less surface carries the same load.
    assert len(heavy.nodes) < len(free.at_load(300.0)[1].nodes)


def test_the_field_holds_the_whole_load(coarse):
    _, pressed = coarse.at_load(300.0)
    field = pressure_field(coarse.patch, pressed)
    assert field.pressure.shape == (len(field.along), len(field.across))
    assert field.pressure.sum() * coarse.patch.area == pytest.approx(pressed.load.sum(), rel=1e-12)
    assert np.all(np.diff(field.along) > 0.0)


def test_a_law_that_is_no_number_is_a_failure(coarse):
    law = attrs.evolve(linear(coarse, 0.01), kernel=broken)
    with pytest.raises(ConvergenceError, match="pressures of the contact law did not converge"):
        coarse.press(Contact(coarse.patch, law), 5e-6)


def test_an_ellipse_that_reaches_around_its_ball_is_no_contact():
    """Rubber in ceramic at 10 N: a major semi-axis above the ball's equator leaves no two points around it."""
    with pytest.raises(MeshError, match="reaches around the ball"):
        Spacing.of((0.1, 1e-3), 3, 4.7e-3, 1e-3)
    assert Spacing.of((1e-3, 1e-4), 3, 4.7e-3, 1e-3).ball_divisions == 90


def test_what_runs_away_is_not_meshed():
    """A contact as large as a ball, and one that no mesh has room for, are failures of the numbers."""
    far = BeyondPatch(-1.0, 0.26, 1e13, across=False)
    reach = Reach((0.2, 0.3), (0.2, 0.3), 1e-4, 100.0, 100.0)
    bearing = rw.build_model(rw.scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})).basis
    assert isinstance(bearing.inner, Ellipse)
    with pytest.raises(ConvergenceError, match="leave the races"):
        reach.grown(far, bearing.inner, 4e-3, 1.2)

    def solve():
        raise far

    def wider(_left):
        raise MeshError("no room")

    with pytest.raises(ConvergenceError, match=r"leave the races.*no room"):
        Pool((None, None), wider=wider).widened(solve)
