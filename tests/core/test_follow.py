"""Branches of steady orbits: folds and backbones in closed form, harmonic balance, monodromy, special points, the command."""

import csv
import json

import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.reference.harmonic_balance import harmonic_balance
from checks.validation.several import article
from raceway import ConvergenceError, SceneError
from raceway.core.periodic.branch import Branch, doubled
from raceway.core.periodic.refinement import displacements
from raceway.core.periodic.search import directly
from raceway.core.periodic.special_points import DOUBLING, FOLD, PAIR, special_points
from raceway.extend import Interrupted
from raceway.points.attractor import QUASI, REPEATS, WANDERS, kind_of_section
from tests.core.validation.followed import OVER, SCENE, by_integration
from tests.core.validation.oscillators import Oscillator, Pressed, natural_frequency


def walked(branch, first, start, until, size=0.1, sense=1.0):
    """Points and special points of a branch until a condition of the point holds."""
    here, points, found = branch.start(first, start, sense), [], []
    for _ in range(600):
        there = branch.step(here, size)
        found += special_points(branch, here, there, size)
        size *= branch.growth(there)
        here = there
        points.append(here)
        if until(here):
            return points, found
    raise AssertionError("the branch does not come to its end")


@pytest.mark.slow
def test_folds_of_a_weak_duffing_oscillator():
    """Its first harmonic alone is the closed form: what that leaves out is (b A^2)^2 3/128 = 2e-8 of w."""
    one = Oscillator(damping=2e-4, factor=1e-3, force=2e-4)
    start = 0.995
    branch = Branch(one.problem, 1e-3, 1.0, 1e-10, 512, aim=1e-3)
    _, found = walked(branch, one.orbit(start, one.force / (1.0 - start**2)), start, lambda p: p.parameter > 1.002)
    assert [special.kind for special in found] == [FOLD, FOLD]
    sizes = [np.abs(special.point.solved.path.q[:, 0]).max() for special in found]
    wanted = one.folds([(special.point.parameter, size) for special, size in zip(found, sizes, strict=True)])
    for special, size, (w, amplitude) in zip(found, sizes, wanted, strict=True):
        assert special.point.parameter == pytest.approx(w, rel=1e-6)
        # The amplitude stands still across neither fold: 1e-8 of w is 1e-4 of the detuning that it follows.
        assert size == pytest.approx(amplitude, rel=1e-3)


def test_backbone_of_a_mass_on_a_hertzian_spring():
    """A force of 1e-8 keeps the orbit within 1e-8 of the free vibration: w = c A^(1/4), its constant by the energy."""
    one = Oscillator(stiffness=0.0, factor=2.0, exponent=1.5, force=1e-8)
    start = float(natural_frequency(2.0, 1.5, 1.0, np.array(1.0)))
    # On one mesh: nothing but the force holds the phase, so that errors along it cannot be told.
    branch = Branch(one.problem, start, 1.0, 1e-6, 8, aim=1e-3)
    amplitude = lambda point: float(np.abs(displacements(point.solved, np.array([0.0, np.pi]))[:, 0]).max())  # noqa: E731
    points, _ = walked(branch, one.orbit(start, 1.0, 80), start, lambda p: amplitude(p) > 10.0, 0.01)
    sizes = np.array([amplitude(point) for point in points])
    assert sizes[-1] > 10.0 * 0.99 and sizes[0] < 1.1
    assert np.array([p.parameter for p in points]) == pytest.approx(natural_frequency(2.0, 1.5, 1.0, sizes), rel=1e-6)


@pytest.fixture(scope="module")
def strong():
    """A Duffing oscillator far from linear, through both folds."""
    one = Oscillator(damping=0.1, factor=1.0, force=0.5)
    branch = Branch(one.problem, 0.5, 1.0, 1e-8, 512, aim=1e-3)
    return one, branch, *walked(branch, one.orbit(0.3, one.force / (1.0 - 0.09)), 0.3, lambda p: p.parameter > 3.0)


def test_orbits_between_folds_by_harmonic_balance(strong):
    one, _, points, found = strong
    assert [special.kind for special in found if special.kind == FOLD] == [FOLD, FOLD]
    unstable = [point for point in points if point.floquet.verdict == "unstable"]
    assert unstable and all(point.floquet.leaves_by == "+1" for point in unstable)
    angles = 2.0 * np.pi * np.arange(128) / 128
    for point in (*unstable[:: max(1, len(unstable) // 3)], points[5], points[-1]):
        q = displacements(point.solved, angles)[:, :1]
        wanted = harmonic_balance(
            lambda x: (x + x**3, np.array([[1.0 + 3.0 * x[0] ** 2]])), np.eye(1), 0.1 * np.eye(1), 0.5 * np.cos(angles)[:, None],
            point.parameter, 1.01 * q, 40, 1.0,
        )  # fmt: skip
        assert np.abs(q - wanted).max() < 1e-6 * np.abs(q).max()


def test_every_fold_is_between_stable_and_unstable(strong):
    _, branch, _, found = strong
    for special in found:
        one = special.point
        near = [branch.step(one, sign * 1e-3) for sign in (-1.0, 1.0)]
        assert abs(one.tangent[-1]) < 1e-6
        assert {point.floquet.verdict for point in near} == {"stable", "unstable"}
        assert (near[0].parameter - one.parameter) * (near[1].parameter - one.parameter) > 0.0


@pytest.fixture(scope="module")
def pressed():
    """A mass on a Hertzian contact under a force near twice its natural frequency: the period doubles."""
    one = Pressed()
    q = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    first = directly(one.problem(2.3), q, one.problem(2.3).system.evaluate(q).stiffness, 1e-8).solved
    branch = Branch(one.problem, 0.1, first.size, 1e-7, 512, aim=1e-3)
    _, found = walked(branch, first, 2.3, lambda p: p.parameter < 1.7, 0.1, -1.0)
    return one, branch, found


def test_period_doublings_of_a_hertzian_contact(pressed):
    """Either side of twice the natural frequency, which the mean softening takes down; one multiplier is -1 there."""
    _, _, found = pressed
    assert [special.kind for special in found] == [DOUBLING, DOUBLING]
    assert found[0].point.parameter > 2.0 > found[1].point.parameter
    for special in found:
        assert np.abs(special.point.floquet.of_span + 1.0).min() < 1e-6


def test_the_doubled_orbit_by_a_poincare_section(pressed):
    """500 turns of DOP853 that begin 0.1 % off the orbit, whose disturbances decay by e^-7 meanwhile."""
    one, branch, found = pressed
    longer, here = doubled(branch, found[0].point)
    size = 0.05
    for _ in range(100):
        here = longer.step(here, size)
        size *= longer.growth(here)
        if abs(here.parameter - found[0].point.parameter) > 0.05:
            break
    assert here.floquet.verdict == "stable"
    path, w = here.solved.path, here.solved.problem.speed
    section = one.section(here.parameter, (1.001 * path.q[0, 0], 1.001 * w * path.v[0, 0]), 500)
    amplitude = here.solved.size
    # Which of the two spans comes first depends on where the integration begins.
    last = section[-2:] if np.abs(section[-1, 0] - path.q[0, 0]) > np.abs(section[-2, 0] - path.q[0, 0]) else section[-3:-1]
    states = np.array([displacements(here.solved, np.array([0.0, 2.0 * np.pi]))[:, 0]])[0]
    assert abs(states[0] - states[1]) > 0.1 * amplitude  # the period is two turns, not one
    assert np.abs(last[:, 0] - states).max() < 1e-5 * amplitude


@pytest.mark.parametrize(
    ("kind", "period", "second"), [(REPEATS, 1, None), (REPEATS, 3, None), (QUASI, None, 0.1234567), (WANDERS, None, None)]
)
def test_sections_are_told_apart(kind, period, second):
    """A point, three points, a closed curve with harmonics, and the logistic map at 3.9."""
    k = np.arange(512)
    if kind == REPEATS:
        section = np.stack([(k % period) * 0.3, np.ones(len(k))], axis=1)
    elif kind == QUASI:
        angle = 2.0 * np.pi * second * k
        section = np.stack([np.cos(angle) + 0.3 * np.cos(2.0 * angle), np.sin(angle) + 0.1 * np.sin(3.0 * angle)], axis=1)
    else:
        x = [0.3]
        while len(x) < 513:
            x.append(3.9 * x[-1] * (1.0 - x[-1]))
        section = np.stack([x[:-1], x[1:]], axis=1)
    told = kind_of_section(section, 1.0)
    assert told[:2] == (kind, period)
    if second is not None:
        assert told[2] == pytest.approx(second, abs=1e-4)


def test_an_orbit_of_two_turns_that_still_settles_is_no_quasi_periodic_motion():
    k = np.arange(512)
    x = (-1.0) ** k * (1.0 + 0.05 * 0.995**k)
    assert kind_of_section(np.stack([x, 0.3 * x], axis=1), 1.0) == (REPEATS, 2, None)


@pytest.mark.slow
def test_the_bearing_s_period_doubles_under_a_radial_load(tmp_path):
    """Near twice the radial natural frequency; the doubled orbit closes after two turns of the reference ring, not after one."""
    load, excitation = {"axial": 400.0, "radial": [200.0, 0.0]}, {**SCENE["excitation"], "force": 150.0}
    tables = {**SCENE, "load": load, "rotor": {"mass": 2.0, "damping": 60.0}, "excitation": excitation}
    found = rw.follow(tables, "excitation.speed_rpm=50000:48500", doubled=True)
    (flip,) = [label for label in found.labels if label.kind == DOUBLING]
    (branch,) = found.doubled
    assert branch.span_deg == 720.0 and branch.rows[0].parameter == flip.row.parameter
    assert branch.rows[0].stiffness == pytest.approx(flip.row.stiffness, rel=1e-9)
    assert branch.rows[-1].verdict == "unstable" and found.rows[0].verdict == "stable"  # back beside the stable orbit
    point = branch.worst[-1]
    size = point.solved.size
    assert np.abs(by_integration(point, 2, 150.0)[2][:3]).max() < 1e-6 * size
    assert np.abs(by_integration(point, 1, 150.0)[2][:3]).max() > 1e-2 * size
    found.save(tmp_path, pictures=True)
    rows = list(csv.DictReader((tmp_path / "follow.csv").open()))
    assert [row["branch"] for row in rows] == ["0"] * len(found.rows) + ["1"] * len(branch.rows)
    assert (tmp_path / "follow.png").is_file()


@pytest.mark.slow
def test_beyond_a_neimark_sacker_point_the_motion_is_quasi_periodic():
    """At its beginning the second frequency is the angle of the pair that crossed; by another second-order method."""
    found = rw.follow(SCENE, "excitation.speed_rpm=21000:22500", turns=1500)
    (one,) = found.attractors
    pairs = [label.angle for label in found.labels if label.kind == PAIR]
    assert one.kind == QUASI
    assert min(pairs) < 2.0 * np.pi * one.second < max(pairs)


@pytest.fixture(scope="module")
def curve():
    return rw.follow(SCENE, "excitation.speed_rpm=10500:30000")


def test_the_article_s_bearing_through_its_folds(curve):
    assert curve.end == "" and curve.rows[-1].parameter == pytest.approx(30000.0)
    kinds = [label.kind for label in curve.labels]
    assert kinds.count(FOLD) == 2 and kinds.count(PAIR) == 4
    for label in curve.labels:
        if label.kind == PAIR:
            assert label.row.multiplier == pytest.approx(1.0, abs=2e-6)
            assert 0.0 < label.angle < np.pi
    assert len(curve.unstable) == 3
    left = {"": 0, "+1": 1, "-1": 1, "pair": 2}
    assert all(o.unstable >= left[o.leaves_by] and (o.unstable > 0) == (o.verdict == "unstable") for o in curve.rows)
    assert any(1.0 < row.multiplier < 1.1 and row.verdict == "unstable" for row in curve.rows)
    folds = [label.row.parameter for label in curve.labels if label.kind == FOLD]
    assert [row.parameter for row in curve.unstable[0]] == folds
    (peak,) = (label.row for label in curve.labels if label.kind == "peak")
    before, ahead = (
        min((row for row in curve.rows if s * (row.arc - peak.arc) > 0.0), key=lambda row: abs(row.arc - peak.arc))
        for s in (-1, 1)
    )
    assert before.swing < peak.swing > ahead.swing


@pytest.mark.slow
def test_a_branch_that_an_internal_resonance_ends_names_it():
    """README's scene, lighter, tilt free, undamped: five times 5184 r/min is the ring's lowest natural frequency, 25 918 r/min."""
    scene = rw.evolve(
        "examples/b7206.toml", {"load.axial": 400.0, "supports.tilt": "free", "excitation.kind": "unidirectional"}
    )
    curve = rw.follow(scene, "excitation.speed_rpm=5000:6000")
    assert "its 5x harmonic outweighs the synchronous (1x) component" in curve.end


@pytest.mark.slow
def test_balls_that_graze_their_races_do_not_lose_the_curve():
    scene = rw.evolve("examples/b7206.toml", {"load.axial": 400.0, "supports.tilt": "free"})
    curve = rw.follow(scene, "excitation.speed_rpm=500:30000")
    assert len(curve.rows) > 50 and curve.end


def test_a_branch_does_not_jump_to_its_neighbour():
    """Two sheets that differ by 0.1 % of the amplitude beside a fold: a branch that falls from one to the other misses its folds, or meets them again."""
    tables = {**SCENE, "rotor": {"mass": 2.0, "damping": 100.0}, "excitation": {**SCENE["excitation"], "force": 100.0}}
    found = rw.follow(tables, "excitation.speed_rpm=30000:33000", points=60)
    folds = [round(label.row.parameter, 2) for label in found.labels if label.kind == FOLD]
    assert len(folds) == len(set(folds)) == 2


def test_files_hold_every_number(curve, tmp_path):
    curve.save(tmp_path)
    content = json.loads((tmp_path / "follow.json").read_text())
    rows = list(csv.DictReader((tmp_path / "follow.csv").open()))
    assert len(rows) == len(content["rows"]) == len(curve.rows)
    for row, known in zip(rows, curve.rows, strict=True):
        assert float(row["stiffness"]) == known.stiffness and float(row["parameter"]) == known.parameter
        z, w = complex(float(row["z_real"]), float(row["z_imag"])), float(row["speed"])
        assert known.damping == pytest.approx(z.imag / w)
        assert known.stiffness == pytest.approx(z.real + known.mass * w**2)
    assert set(content["columns"]) <= set(rows[0])


@pytest.mark.parametrize(("over", "words"), [
    ("bearing.ball_count=8:12", "takes whole numbers only"), ("integrator.turns=2:3", "setting of a method"),
    ("excitation.ramp_turns=1:2", "has no effect on the motion"), ("excitation.speed_rpm=-500:3000", "greater than 0"),
    ("excitation.speed_rpm=3000:3000", "has equal ends"), ("bearing.conformity_inner=0.52:1.2", "conformity_inner"),
    ("excitation.speed_rpm=0:3000", "greater than 0"), ("contact.kind=hertz:penalty", "takes a word or a switch"),
    ("load.axial=400:0", "no load acts"), ("load.axial=nan:400", "finite"),
    ("excitation.force=40:0", "the force is zero"), ("load.radial[5]=0:100", r"did you mean 'load.radial\[1\]'"),
    ("excitation.speed_rpm=1:2:3", "must have the form"), ("speed", "must have the form"),
])  # fmt: skip
def test_what_cannot_be_followed_is_refused(over, words):
    with pytest.raises((SceneError, ConvergenceError), match=words):
        rw.follow(SCENE, over)


def test_orbiting_balls_are_refused_with_what_to_do():
    with pytest.raises(SceneError, match="kinematics.orbiting=false"):
        rw.follow(
            {**SCENE, "kinematics": {"orbiting": True}, "excitation": {**SCENE["excitation"], "kind": "bidirectional"}}, OVER
        )


def test_down_to_no_damping_beyond_which_there_is_no_scene():
    """The last value is reached itself, by differences to one side; there is an orbit, which nothing damps."""
    found = rw.follow(SCENE, "rotor.damping=20:0")
    assert found.end == "" and found.rows[-1].parameter == 0.0
    undamped = rw.run({**SCENE, "rotor": {"mass": 2.0}, "integrator": {"kind": "periodic", "tolerance": 1e-9}})
    assert found.rows[-1].stiffness == pytest.approx(undamped.equivalent_stiffness, rel=1e-6)
    assert found.rows[-1].verdict == "neutral"


def test_meshes_follow_the_natural_frequencies_along_the_branch():
    """A tilt support of 1000 times the stiffness: meshes for the first value's vibrations would say 4e11 of a growth of 1."""
    found = rw.follow(SCENE, "supports.tilt=3e4:1e6")
    assert found.end == "" and {row.verdict for row in found.rows} == {"stable"} and not found.labels


@pytest.mark.slow
def test_a_mesh_that_an_orbit_needs_is_not_given_up():
    """800 N, tilt free: the mesh that is fit for the ring's vibrations alone shifts the orbit by 3 r/min."""
    tables = article(800.0, kind="periodic")
    tables["contact"] = {"damping": 1e-3}
    tables["excitation"] |= {"amplitude": "unbalance", "speed_rpm": 10980.0}
    found = rw.follow(tables, "excitation.speed_rpm=10980:15000", points=10)
    assert len(found.rows) == 10 and found.rows[-1].parameter > 10990.0, found.end
    assert max(row.error for row in found.rows) <= 1e-6  # that meshes are kept fit for


def test_a_key_in_a_list_and_values_with_units():
    """A radial load of 10 N against the force's axis: the branch ends where a run says."""
    found = rw.follow(SCENE, "load.radial[1]=0:0.01 kN", points=40)
    there = {**SCENE, "load": {"axial": 400.0, "radial": [0.0, 10.0]}, "integrator": {"kind": "periodic", "tolerance": 1e-9}}
    assert found.rows[-1].parameter == pytest.approx(10.0)
    assert found.rows[-1].stiffness == pytest.approx(rw.run(there).equivalent_stiffness, rel=1e-6)


def test_ctrl_c_keeps_the_orbits_so_far(tmp_path):
    def stop(what, done, total):
        if what == "orbits" and done == 5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as caught:
        rw.follow(SCENE, OVER, out=tmp_path, progress=stop)
    partial = caught.value.partial
    content = json.loads((tmp_path / "follow.json").read_text())
    assert len(partial.rows) == len(content["rows"]) == 5
    here = partial.rows[-1].parameter
    assert content["end"].startswith(f"stopped at {here:.6g} after 5 orbits") and f"={here:.6g}:30000" in content["end"]


def test_the_command_writes_and_tells(tmp_path):
    (tmp_path / "s.toml").write_text(
        'title = "t"\n[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n[rotor]\nmass = 2.0\ndamping = 1000.0\n[excitation]\n'
        'kind = "bidirectional"\nspeed_rpm = 6000.0\namplitude = "constant"\nforce = 50.0\n'
    )
    found = invoke("follow", str(tmp_path / "s.toml"), "--over", "load.axial=1000:600", "--out", str(tmp_path / "out"))
    assert found.exit_code == 0, found.output
    assert "steady orbits over load.axial" in found.output
    content = json.loads((tmp_path / "out" / "follow.json").read_text())
    for row in content["rows"]:  # circles: the force over the displacement is |Z|
        assert row["amplitude"] == pytest.approx(50.0 / np.hypot(row["z_real"], row["z_imag"]), rel=1e-6)
    stiffness = [row["stiffness"] for row in content["rows"]]
    assert stiffness[0] > 1.1 * stiffness[-1]  # a lighter preload makes a softer bearing
    direct = rw.run(
        rw.evolve(tmp_path / "s.toml", {"load.axial": 600.0, "integrator": {"kind": "periodic", "tolerance": 1e-9}})
    )
    assert stiffness[-1] == pytest.approx(direct.equivalent_stiffness, rel=1e-6)
    assert (tmp_path / "out" / "follow.png").stat().st_size > 10_000
