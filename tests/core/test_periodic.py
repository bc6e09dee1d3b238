"""Steady orbits solved for directly: against collocation in Fourier series, symmetry, multipliers, folds, refusals."""

import json
from itertools import islice

import attrs
import numpy as np
import pytest
from scipy.linalg import expm

from checks.validation.command_line import ARTICLE, invoke
from checks.validation.scenes import built_in, rotating
from checks.validation.several import heavy
from raceway import SceneError, run
from raceway.core.periodic.branch import Branch
from raceway.core.periodic.branches import force_continuation
from raceway.core.periodic.collocation import Problem, newton_iteration, solve, stiff
from raceway.core.periodic.refinement import motion_at, record
from raceway.core.periodic.search import Recorded, guess, highest_order, mesh_of, neighbour_of, problem_of, response
from raceway.core.periodic.steady import find, static_equilibrium
from raceway.core.periodic.turn import one_turn
from raceway.extend import Motion, Schedule, integrate, steady_orbit
from raceway.pipeline.simulate import last_turn, steady_record
from raceway.testing import model_of, solve_equilibrium
from raceway.testing.systems import PRELOAD, SPEED, along_x, contact_system, exact, linear_system, motion

Periodic = built_in("integrator", "periodic")


def scene(kind="periodic", axial=1000.0, tilt="locked", inertia=False, **tables):
    found = rotating(axial, tilt, 12000.0, inertia, kind)
    for table, values in tables.items():
        found[table] = {**found.get(table, {}), **values}
    return found


def solved(tables, **options):
    return run({**tables, "integrator": {"kind": "periodic", **options}})


ONE_WAY = {"kind": "unidirectional"}


@pytest.mark.parametrize("tables", [
    scene(), scene(tilt="free", inertia=True), scene(excitation=ONE_WAY),
    scene(tilt="free", inertia=True, kinematics={"gyroscopic": "shared"}),
    scene(contact={"kind": "penalty", "damping": 500.0}, supports={"tilt": 2e4}),
    scene(inertia=True, supports={"axial": "displacement"}),
], ids=["locked", "free", "one way", "gyroscopic", "damped penalty", "held axially"])  # fmt: skip
def test_equals_collocation_in_fourier_series(tables):
    result = solved(tables, tolerance=1e-9)
    model = model_of(tables)
    orbit = steady_orbit(model.system, model.excitation.period_s, solve_equilibrium(model).displacement, 65, tolerance=1e-11)
    line = np.fft.fft(orbit.displacement, axis=0)[1, 1:3]
    push = np.fft.fft(orbit.force, axis=0)[1, 1:3]
    wanted = np.vdot(push, push) / np.vdot(push, line)
    # Equal but for the tails of both: 65 samples leave 1e-10 of motions without lift-off, imbalances 1e-9.
    assert abs(result.identification.dynamic_stiffness - wanted) < 1e-8 * abs(wanted)
    assert result.error["total"] < 1e-8


@pytest.mark.parametrize(
    "tables",
    [scene(axial=200.0), scene(tilt="free", inertia=True), scene(contact={"damping": 500.0})],
    ids=["lift-off", "free", "damped"],
)
def test_a_pitch_tells_the_whole_turn(tables):
    pitch, turn = solved(tables), solved(tables, symmetry="none")
    assert pitch.stability["floquet"]["span_deg"] == pytest.approx(30.0)
    assert turn.stability["floquet"]["span_deg"] == pytest.approx(360.0)
    one, two = (result.simulation.record for result in (pitch, turn))
    size = np.ptp(two.displacement[:, 1])
    assert np.abs(one.displacement - two.displacement)[:, :3].max() < 2e-7 * size  # the default tolerance, twice
    # Forces of single balls say that they are renumbered rightly.
    assert np.abs(one.contact_force - two.contact_force).max() < 1e-5 * two.contact_force.max()
    found = [sorted(m["abs"] for m in result.stability["floquet"]["multipliers"]) for result in (pitch, turn)]
    assert found[0] == pytest.approx(found[1], abs=1e-6)


def test_orbiting_balls_by_their_own_pitch():
    """Fixed balls under the same force, but seen from balls that travel: K is that of fixed balls, to their small ripple."""
    still, orbiting = solved(scene(axial=400.0)), solved(scene(axial=400.0, kinematics={"orbiting": True}))
    assert orbiting.stability["floquet"]["span_deg"] == pytest.approx(50.0, abs=0.1)  # 30 / (1 - cage speed over spin speed)
    pair = [result.identification.equivalent_stiffness for result in (still, orbiting)]
    assert pair[0] == pytest.approx(pair[1], rel=1e-4)


@pytest.mark.slow
def test_condensed_bodies():
    """Structural approaches have rates and pitches too; the coarse mesh is the same on both sides."""
    tables = scene(bodies={"kind": "condensed"}, mesh={"element_size": 1.5e-3}, contact={"damping": 500.0})
    pitch, turn = solved(tables), solved(tables, symmetry="none")
    off = pitch.identification.dynamic_stiffness / turn.identification.dynamic_stiffness - 1.0
    assert abs(off) < 2e-7
    by_time = run({**tables, "integrator": {"kind": "newmark", "turns": 6, "steps_per_turn": 720}})
    # Newmark's error at 720 steps is 1.8e-7, its transient's 1e-6.
    assert abs(by_time.identification.dynamic_stiffness / pitch.identification.dynamic_stiffness - 1.0) < 5e-6


def test_multipliers_of_a_linear_system():
    system = linear_system()
    record = integrate(
        Periodic(tolerance=1e-9), system, motion(system, np.zeros(5), np.zeros(5)), Schedule(2.0 * np.pi / SPEED / 36, 36, 1)
    )
    chosen = np.ix_(system.free > 0.0, system.free > 0.0)
    inverse = np.linalg.inv(system.mass[chosen])
    flow = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-inverse @ system.stiffness[chosen], -inverse @ system.damping[chosen]]]
    )
    wanted = np.sort(np.abs(np.linalg.eigvals(expm(2.0 * np.pi / SPEED * flow))))
    fate = record.counts["floquet"]
    assert np.sort([m["abs"] for m in fate["multipliers"]]) == pytest.approx(wanted, abs=1e-9)
    assert fate["verdict"] == "stable"
    assert fate["leaves_by"] is None


@pytest.fixture(scope="module")
def softening():
    """A mass on a Hertzian contact, pushed to and fro at 0.85 of its natural frequency: a fold on the way up."""
    system = contact_system()
    k, m = float(system.law_params[0, 0]), float(system.mass[0, 0])
    rest = (PRELOAD / k) ** (2.0 / 3.0)
    w = 0.85 * np.sqrt(1.5 * PRELOAD / rest / m)
    damping = np.zeros((5, 5))
    damping[0, 0] = 0.02 * m * w
    force = np.array([0.45 * PRELOAD, w])
    system = attrs.evolve(system, damping=damping, force=along_x, force_params=force)
    q = np.array([rest, 0.0, 0.0, 0.0, 0.0])
    return Problem(system, w, one_turn(system)), q, system.evaluate(q).stiffness


def test_a_branch_passes_its_folds(softening):
    problem, q, tangent = softening
    points = list(force_continuation(problem, q, tangent, mesh_of(problem, highest_order(problem, tangent))))
    shares = np.array([point.parameter for point in points])
    assert points[-1].parameter >= 1.0
    assert any(point.folded for point in points)
    assert (np.diff(shares) < 0.0).any()
    # Between two folds one real multiplier is above 1; before and after, none is.
    middle = points[int(np.argmax(np.diff(shares) < 0.0)) + 2]
    assert middle.floquet.leaves_by == "+1"
    assert points[1].floquet.verdict == points[-1].floquet.verdict == "stable"


def test_what_lies_beyond_a_fold_satisfies_the_equations(softening):
    """An integration to 1e-11 from the motion's start comes back to it after a turn, lift-off and impact on the way."""
    problem, q, tangent = softening
    found = find(problem, q, tangent, 1e-8)
    assert found.how == "from rest"
    path, size = found.refined.solved.path, found.refined.solved.size
    start = motion(problem.system, path.q[0].copy(), path.v[0] * problem.speed)
    q_end, v_end = exact(problem.system, start, np.array([2.0 * np.pi / problem.speed]))
    off = np.abs([q_end[0, 0] - path.q[0, 0], v_end[0, 0] / problem.speed - path.v[0, 0]]).max()
    assert off < 1e-6 * size  # the integration's own error at impacts is 1e-8 of the motion, and a turn carries it on


def test_a_branch_over_the_speed(softening):
    problem, q, tangent = softening
    low = attrs.evolve(problem, speed=0.5 * problem.speed, share=0.2)
    begin = find(low, q, tangent, 1e-6).refined.solved

    def at(speed):
        return Problem(problem.system, speed, problem.symmetry, 0.2, problem.speed)

    branch = Branch(at, 0.1 * problem.speed, begin.size)
    wanted = 0.6 * problem.speed
    points = branch.follow(branch.start(begin, low.speed), 0.2)
    last = next(point for point in islice(points, 60) if point.parameter >= wanted)
    direct = find(at(last.parameter), q, tangent, 1e-8).refined.solved
    assert last.solved.path.q[0, 0] == pytest.approx(direct.path.q[0, 0], abs=1e-5 * direct.size)


def test_the_slope_of_a_growing_force_is_the_difference_quotient(softening):
    """Each point of the branch from rest with the known slope and by differences."""
    problem, q, tangent = softening
    nodes = mesh_of(problem, highest_order(problem, tangent))
    first = next(force_continuation(problem, q, tangent, nodes))

    def followed(slope):
        branch = Branch(lambda share: attrs.evolve(problem, share=share), 1.0, 1e-6, 1e-4, 512, slope)
        return list(islice(branch.follow(branch.start(first.solved, 0.0), 0.1), 12))

    known, by_differences = followed(lambda at, path: -at.force(at.angles(path.nodes))), followed(None)
    for one, two in zip(known, by_differences, strict=True):
        assert one.parameter == pytest.approx(two.parameter, abs=1e-6)
        assert one.solved.path.q[0, 0] == pytest.approx(two.solved.path.q[0, 0], abs=1e-6 * two.solved.size + 1e-15)


def test_a_motion_is_kept_where_two_exist(softening):
    """Down the upper branch by 3 % of the force at a time to between the folds; there the search from rest finds the lower motion."""
    problem, q, tangent = softening
    points = list(force_continuation(problem, q, tangent, mesh_of(problem, highest_order(problem, tangent))))
    turned = int(np.argmax(np.diff([point.parameter for point in points]) < 0.0))
    high, low = points[turned].parameter, min(point.parameter for point in points[turned:])
    near, share = neighbour_of(points[-1].solved, q, tangent), points[-1].parameter
    while share > 0.5 * (low + high):
        share *= 0.97
        kept = find(attrs.evolve(problem, share=share), q, tangent, 1e-7, near, True)
        assert not kept.coexisting
        near = neighbour_of(kept.refined.solved, q, tangent)
    assert low < share < high
    searched = find(attrs.evolve(problem, share=share), q, tangent, 1e-7, near)
    assert searched.refined.solved.size < 0.7 * kept.refined.solved.size


def test_newton_ends_at_its_tolerance():
    """Where the answer is solved for once more, to rounding, it moves by no more than that; a sweep near the end doubles the digits."""
    sweeps = []
    model = model_of(scene(axial=400.0, tilt="free"))
    equilibrium = solve_equilibrium(model)
    problem = Problem(model.system, 1256.0, one_turn(model.system))
    nodes = mesh_of(problem, highest_order(problem, equilibrium.stiffness))
    for tolerance in (1e-4, 1e-6, 1e-8):
        once = solve(problem, guess(problem, equilibrium.displacement, equilibrium.stiffness, nodes), tolerance)
        assert once.correction <= tolerance * once.size
        sweeps.append(once.sweeps)
        again = solve(problem, once.path, 1e-13)
        assert np.abs((again.path.q - once.path.q) / problem.weight).max() <= tolerance * once.size
    assert sweeps[-1] <= sweeps[0] + 2


def test_a_start_off_the_equilibrium_is_settled():
    model = model_of(scene())
    equilibrium = solve_equilibrium(model)
    there = equilibrium.displacement + np.array([1e-6, 2e-6, 0.0, 0.0, 0.0])
    off = Motion(there, np.zeros(5), np.zeros(5), equilibrium.ball, equilibrium.ball.copy())
    q, tangent = static_equilibrium(model.system, off)
    # Newton's tolerance of 1e-11 of the forces.
    assert q == pytest.approx(equilibrium.displacement, abs=1e-13)
    assert tangent == pytest.approx(equilibrium.stiffness, rel=1e-8, abs=1e-2)


@pytest.mark.parametrize("damping", [0.001, 500.0])
def test_rates_of_the_balls_are_the_derivatives_of_their_places(damping):
    """Put in after every sweep, or solved for; 1e-3 of the largest rate for balls that are interpolated."""
    model = model_of(scene(contact={"damping": damping}, inertia=True))
    equilibrium, step = solve_equilibrium(model), 1e-3
    problem = Problem(model.system, 1256.0, one_turn(model.system))
    path = find(problem, equilibrium.displacement, equilibrium.stiffness, 1e-8).refined.solved.path
    assert stiff(problem, path) == (damping == 500.0)
    angles = np.linspace(0.1, 6.0, 50)
    ahead, behind = (motion_at(problem, path, angles + sign * step)[3][:, :, :2] for sign in (1.0, -1.0))
    rate = motion_at(problem, path, angles)[4][:, :, :2]
    assert np.abs((ahead - behind) / (2.0 * step) * problem.speed - rate).max() < 1e-3 * np.abs(rate).max()


def test_a_motion_of_which_rounding_is_much_takes_no_finer_mesh(monkeypatch):
    """Of some 1e-13 m beside 1e-5 m from zero, with dashpots: neither finer meshes nor more turns of the rates tell more."""
    taken = []
    monkeypatch.setattr(
        "raceway.core.periodic.collocation.newton_iteration",
        lambda *given: (taken.append(given[1].intervals), newton_iteration(*given))[1],
    )
    model = model_of(scene(contact={"damping": 500.0}, excitation={"unbalance": 1e-13}))
    equilibrium = solve_equilibrium(model)
    problem = Problem(model.system, 1256.0, one_turn(model.system))
    refined = find(problem, equilibrium.displacement, equilibrium.stiffness, 1e-8).refined
    assert 1e-8 < refined.error <= refined.solved.rounding < 1e-3
    assert len(taken) <= 5 and len(set(taken)) == 1


@pytest.mark.parametrize(("tables", "words"), [
    (scene(contact={"friction": 0.1}), "contact.friction"),
    (scene(kinematics={"orbiting": True}, load={"radial": [100.0, 0.0]}), "kinematics.orbiting"),
    (scene(excitation=ONE_WAY, kinematics={"orbiting": True}), "kinematics.orbiting"),
    (scene(bodies={"kind": "condensed"}, contact={"discretisation": "nodal", "kind": "penalty"}), "nodal"),
])  # fmt: skip
def test_refusals_name_reason_and_remedy(tables, words):
    with pytest.raises(SceneError) as caught:
        solved(tables)
    assert words in str(caught.value)
    assert "newmark" in str(caught.value)


def test_a_run_up_is_refused():
    tables = scene()
    tables["excitation"] = {"kind": "run_up", "first_speed_rpm": 9000.0, "speed_rpm": 12000.0, "duration_s": 0.1,
                            "unbalance": 6e-4}  # fmt: skip
    with pytest.raises(SceneError, match="periodic"):
        solved(tables)


def test_the_result_tells_the_multipliers():
    content = json.loads(json.dumps(solved(scene()).to_dict(), allow_nan=False))
    fate = content["stability"]["floquet"]
    assert len(fate["multipliers"]) == 6
    assert fate["verdict"] == "neutral"  # next to no damping
    assert fate["found"] == "directly"
    assert content["error"]["transient"] == 0.0
    assert content["error"]["time_step"] <= 1e-7


def test_far_below_resonance_the_message_names_the_share_and_the_way_out():
    found = invoke("run", ARTICLE, "--set", "integrator.kind=periodic", "--set", "excitation.speed_rpm=1")
    assert found.exit_code == 1
    words = " ".join(found.output.split())
    assert "ends at 0 % of the force" in words and "quasi_static" in words and "the corrector diverges" in words


@pytest.mark.parametrize("which", [0, 1])
def test_a_recorded_turn_leads_to_its_own_motion(which):
    """80 kg, two stable motions: a turn of each leads to that one, without it the first is found."""
    model = model_of(heavy(80.0))
    equilibrium, period = solve_equilibrium(model), model.excitation.period_s
    system = model.system
    problem = problem_of(system, 2.0 * np.pi / period, equilibrium.displacement)
    found = find(problem, equilibrium.displacement, equilibrium.stiffness, 1e-8)
    lasting = [one.refined.solved for one in found.all if one.floquet.verdict != "unstable"]
    assert len(lasting) == 2
    turn = record(lasting[which], Schedule(period / 72, 72, 2), {})
    settled = steady_record(model, equilibrium, last_turn(turn, period))
    there = settled.displacement[4::5] - turn.displacement[72:]
    assert np.abs(there[:, 1:3]).max() < 1e-6 * np.ptp(turn.displacement[:, 1])
    alone = steady_record(model, equilibrium)
    assert (np.abs(alone.displacement - settled.displacement).max() < 1e-9) == (which == 0)


def test_an_unstable_motion_of_the_same_problem_is_not_searched_for_again():
    """80 kg: the motion between the two stable ones stays what it is, at another speed it leads to one that lasts."""
    model = model_of(heavy(80.0))
    equilibrium, w = solve_equilibrium(model), 2.0 * np.pi / model.excitation.period_s
    q, tangent = equilibrium.displacement, equilibrium.stiffness
    problem, beside = (problem_of(model.system, speed, q) for speed in (w, 1.001 * w))
    (unstable,) = (one for one in find(problem, q, tangent, 1e-8).all if one.floquet.verdict == "unstable")
    again = find(problem, q, tangent, 1e-7, unstable.neighbour(q, tangent), True)
    assert again.floquet.largest == pytest.approx(unstable.floquet.largest, rel=1e-5)
    assert find(beside, q, tangent, 1e-7, unstable.neighbour(q, tangent), True).floquet.verdict != "unstable"


@pytest.mark.parametrize("count", [8, 9])
def test_a_recorded_turn_is_met_at_its_samples(softening, count):
    problem, q, tangent = softening
    values = np.random.default_rng(count).normal(size=(count, 5))
    turn = Recorded(2.0 * np.pi / problem.speed, values, values, values)
    nodes = 2.0 * np.pi / count * np.arange(count + 1)
    path = turn.first_guess(problem, q, tangent, nodes)
    assert np.abs(path.q[:-1] - values).max() < 1e-13
    assert np.abs(path.v[:-1] * problem.speed - values).max() < 1e-13


def test_the_derivative_by_the_speed_is_that_of_differences():
    """Of a ring with a damped rotor and dashpots in the contacts, whose force keeps its clock."""
    model = model_of(scene(inertia=True, rotor={"mass": 1.5, "damping": 500.0}, contact={"damping": 100.0}))
    q, w = solve_equilibrium(model).displacement, 2.0 * np.pi / model.excitation.period_s
    problem = problem_of(model.system, w, q, False)
    path = find(problem, q, model.system.evaluate(q).stiffness, 1e-6).refined.solved.path

    def end(by_parameter):
        branch = Branch(lambda part: attrs.evolve(problem, speed=part * w, clock=w, by_parameter=by_parameter), 0.1, 1e-6)
        return branch.along(path, 1.0, np.zeros(2 * len(problem.free) + 1)).solved.eliminated.span_transfer[:, -1]

    known, by_differences = end(w), end(0.0)
    # Forces of some hundred newtons rounded to 1e-13, over a step of 1e-7 of the speed.
    assert np.abs(known - by_differences).max() < 1e-5 * np.abs(known).max()
    assert np.abs(known).max() > 0.0


def test_the_linear_response_at_another_speed_has_the_lines_of_the_force():
    """A branch over the speed keeps the bodies' clock: one turn of the force is one of its own angle."""
    model = model_of(scene())
    q, w = solve_equilibrium(model).displacement, 2.0 * np.pi / model.excitation.period_s
    tangent = model.system.evaluate(q).stiffness
    here = problem_of(model.system, w, q, False)
    for ratio in (0.85, 1.15):
        orders, lines = response(attrs.evolve(here, speed=ratio * w, clock=w), tangent)
        assert orders.tolist() == [1]
        at = np.linalg.inv(tangent[1:3, 1:3] - (ratio * w) ** 2 * model.system.mass[1:3, 1:3])
        known = np.linalg.inv(tangent[1:3, 1:3] - w**2 * model.system.mass[1:3, 1:3])
        _, wanted = response(here, tangent)
        assert np.abs(lines[0, 1:3] - at @ np.linalg.solve(known, wanted[0, 1:3])).max() < 1e-9 * np.abs(wanted).max()
