"""Several steady motions under one force: the stable one is taken, all are told, by every integrator alike."""

from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from checks.validation.several import article, by_integration, heavy
from raceway import ConvergenceError, extend, run, scene_from_dict
from raceway.core.periodic.search import HIGHEST
from raceway.extend import differentiation


def z_of(one):
    return complex(one["dynamic_stiffness"]["real"], one["dynamic_stiffness"]["imag"])


def by_own_turn(result, damping=0.0):
    """Z and largest multiplier by an integration of its own, whose turn must close."""
    z, multiplier, gap = by_integration(result, damping)
    assert gap < 1e-7
    return z, multiplier


@pytest.mark.slow
def test_the_stable_motion_beyond_a_fold():
    """82 kg: the motion that grows out of rest turns back below the whole force; no transient of 12 turns finds the other."""
    result = run(heavy(82.0, kind="periodic", tolerance=1e-9))
    z = result.identification.dynamic_stiffness
    wanted, multiplier = by_own_turn(result, 5000.0)
    assert abs(z - wanted) < 1e-6 * abs(wanted)
    assert multiplier == pytest.approx(result.simulation.orbits[0]["multiplier"], abs=1e-6)
    assert multiplier < 1.0
    by_time = run(heavy(82.0))
    assert by_time.simulation.start.kind == "orbit"
    assert abs(by_time.identification.dynamic_stiffness - z) < 2.0 * by_time.error["total"] * abs(z)
    assert by_time.error["total"] < 1e-3


@pytest.mark.parametrize("kind", ["periodic", "newmark"])
def test_two_stable_motions_are_told(kind):
    """80 kg: between the folds."""
    result = run(heavy(80.0, kind=kind))
    told = result.to_dict()["motion"]["orbits"]
    lasting = [one for one in told if one["stable"]]
    assert len(lasting) == 2 and len(told) == 3
    assert [one["taken"] for one in told] == [True, False, False]
    assert abs(z_of(told[0]) - result.identification.dynamic_stiffness) < 1e-3 * abs(z_of(told[0]))
    assert min(one["multiplier"] for one in told if not one["stable"]) > 1.2
    assert any("2 steady motions" in text for text in result.warnings)
    with (console := Console(width=200, file=StringIO())).capture() as shown:
        console.print(result.screen())
    words = shown.get()
    assert "Steady motions" in words and "-7.548 + 7.854j" in words


@pytest.mark.slow
def test_without_damping_the_branch_leads_through_no_force():
    """The motion opposite in phase is the one that the branch meets at the opposite force, half a turn later."""
    result = run(heavy(82.0, damping=0.0, kind="periodic", tolerance=1e-9))
    wanted, _ = by_own_turn(result)
    assert wanted.real < 0.0
    assert abs(result.identification.dynamic_stiffness - wanted) < 1e-6 * abs(wanted)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("axial", "speed", "amplitude", "inertia", "found"),
    [(800.0, 10980.0, "constant", True, "from a higher speed"), (400.0, 13492.5, "unbalance", False, "from a lower speed")],
)
def test_a_motion_that_only_another_speed_or_load_leads_to(axial, speed, amplitude, inertia, found):
    """Points of the article's study at which nothing grows out of rest: the orbit closes in a turn of the reference ring."""
    tables = article(axial, kind="periodic", tolerance=1e-9)
    tables["excitation"] |= {"speed_rpm": speed, "amplitude": amplitude}
    tables["kinematics"] = {"ball_inertia": inertia, "gyroscopic": "none", "ring_growth": False}
    result = run(tables)
    assert result.simulation.orbits[0]["found"] == found
    z, multiplier, gap = by_integration(result)
    assert gap < 1e-6
    assert abs(z - result.identification.dynamic_stiffness) < 1e-6 * abs(z)
    assert multiplier == pytest.approx(result.simulation.orbits[0]["multiplier"], abs=1e-4)


def test_a_heavier_load_leads_to_the_motion_that_a_lower_speed_leads_to(monkeypatch):
    """That of the test above, which integrates it over time."""
    tables = article(400.0, kind="periodic", tolerance=1e-9)
    tables["excitation"] |= {"speed_rpm": 13492.5, "amplitude": "unbalance"}
    tables["kinematics"] = {"ball_inertia": False, "gyroscopic": "none", "ring_growth": False}
    for speeds in ("_NEAR", "_RATIOS"):
        monkeypatch.setattr(f"raceway.core.periodic.branches.{speeds}", ())
    result = run(tables)
    assert result.simulation.orbits[0]["found"] == "from a heavier axial load"
    assert abs(result.identification.dynamic_stiffness - 24.4011554e6) < 1e-7 * 24.4e6


def test_a_motion_is_continued_where_it_is_unstable():
    """400 N, one direction, tilt free: unstable at 12 990 r/min, where a search leads to it without damping only, and not at the speeds beside."""
    motions, near = [], None
    for speed in (12487.5, 12990.0, 13492.5):
        tables = article(400.0, kind="periodic", tolerance=1e-9)
        tables["excitation"] |= {"speed_rpm": speed, "amplitude": "unbalance"}
        tables["kinematics"] = {"ball_inertia": False, "gyroscopic": "none", "ring_growth": False}
        near = extend.run(scene_from_dict(tables), near=near, stay="unstable")
        motions.append(near.stability["floquet"])
    assert [motion["verdict"] == "unstable" for motion in motions] == [False, True, False]
    assert {motion["found"] for motion in motions} == {"directly"}


@pytest.mark.slow
def test_a_branch_that_closes_leads_to_the_stable_motion():
    """800 N: two unstable motions, and a stable one that a branch whose turns do not close passes by."""
    result = run(article(800.0, kind="periodic", tolerance=1e-9))
    assert [one["stable"] for one in result.simulation.orbits] == [True, False, False]
    assert result.identification.dynamic_stiffness.real == pytest.approx(60.11e6, rel=1e-3)
    z, multiplier, gap = by_integration(result, 0.0)
    assert gap < 1e-11  # what an integration to 1e-13 leaves in a turn
    assert abs(z - result.identification.dynamic_stiffness) < 1e-8 * abs(z)
    assert multiplier == pytest.approx(1.0, abs=1e-6)


@pytest.mark.slow
def test_the_least_damping_does_not_hide_the_stable_motion():
    """800 N: a crossing of branches that any damping parts; the motion beyond it is the one that counts."""
    tables = article(800.0, kind="periodic", tolerance=1e-9)
    alone = run(tables).identification.dynamic_stiffness
    tables["contact"] = {"damping": 1e-6}
    result = run(tables)
    orbit, z = result.simulation.orbits[0], result.identification.dynamic_stiffness
    assert [one["stable"] for one in result.simulation.orbits] == [True, False, False]
    assert orbit["multiplier"] < 1.0
    assert result.identification.equivalent_stiffness == pytest.approx(65.2e6, rel=1e-4)
    # Of first order in c is the phase alone: w c times a number of the size of balls and harmonics.
    assert 0.0 < z.imag < 100.0 * 2.0 * np.pi * 250.0 * 1e-6
    assert z.real == pytest.approx(alone.real, rel=1e-5)


@pytest.mark.slow
def test_a_transient_on_an_unstable_orbit_says_so():
    result = run(article(500.0, turns=60))
    first = result.simulation.orbits[0]
    assert first["taken"] and first["multiplier"] == pytest.approx(
        by_own_turn(run(article(500.0, kind="periodic", tolerance=1e-9)))[1], abs=0.001
    )
    assert any("unstable" in text and "1.585 times per turn" in text for text in result.warnings)
    assert result.error["transient"] >= result.identification.spread > 1e-3


def test_turns_that_do_not_repeat_after_a_failed_search_have_no_error(monkeypatch):
    """The ramp of 12 turns is on its way from one motion to another: its windowed lines agree to 3 %, its Z is off by 120 %."""

    def none(*_):
        raise ConvergenceError("none is found")

    monkeypatch.setattr("raceway.core.periodic.steady.starting_orbit", none)
    result = run(heavy(82.0))
    assert result.simulation.start.kind == "ramp"
    assert result.error["total"] is None and "do not repeat" in result.error["how"]["total"]
    assert result.error["transient"] >= result.identification.spread > 0.01


def test_a_near_linear_motion_is_told_alone():
    result = run(heavy(20.0))
    (only,) = result.simulation.orbits
    assert only["taken"] and only["verdict"] == "stable" and only["found"] == "directly"
    assert not any("motion" in text for text in result.warnings)
    orbit = result.simulation.start.orbit
    derivative = differentiation(len(orbit.displacement), orbit.period)
    for path, rate in ((orbit.displacement, orbit.velocity), (orbit.velocity, orbit.acceleration)):
        # 65 samples of a motion without lift-off, differentiated.
        assert np.abs(derivative @ path - rate).max() < 1e-4 * np.abs(rate).max()
    # Half of what the ring goes to and fro along the direction in which that is most; harmonics are some percent.
    angles = np.linspace(0.0, np.pi, 90)
    along = orbit.displacement[:, 1:3] @ [np.cos(angles), np.sin(angles)]
    assert only["amplitude_m"] == pytest.approx(0.5 * np.ptp(along, axis=0).max(), rel=0.1)


def test_with_friction_orbits_are_no_motions_of_the_scene():
    tables = heavy(80.0)
    tables["contact"]["friction"] = 0.03
    result = run(tables)
    assert result.simulation.orbits == []
    assert any(text.startswith("without friction: 2 steady motions") for text in result.warnings)


def test_an_error_estimate_lets_no_force_grow_on_a_mesh_of_thousands_of_intervals(monkeypatch):
    """A large pair at 220 r/min, its preload lifted off by radial forces: 24 steps were held against a search of 1.6 GB."""
    tables = {
        "bearing": {
            "ball_diameter": 0.056, "pitch_diameter": 0.623, "ball_count": 17, "conformity_inner": 0.535,
            "conformity_outer": 0.5586, "radial_clearance": 2.1e-4,
        },
        "load": {"axial": 0.28, "radial": [-744.5, 209.0]},
        "rotor": {"mass": 0.065, "transverse_inertia": 0.0103},
        "contact": {"kind": "penalty", "damping": 300.0},
        "kinematics": {"gyroscopic": "none", "ring_growth": False},
        "integrator": {"kind": "newmark", "turns": 1, "steps_per_turn": 24, "start": "static"},
        "excitation": {"kind": "bidirectional", "speed_rpm": 219.84, "unbalance": 1.93e-6},
    }  # fmt: skip
    meshes = []

    def newton(problem, first, *rest):
        meshes.append(first.intervals)
        raise ConvergenceError("not found")

    monkeypatch.setattr("raceway.core.periodic.search.solve", newton)
    monkeypatch.setattr("raceway.core.periodic.branches.solve", newton)
    run(tables)
    assert meshes, "the motion is searched for directly"
    assert max(meshes) <= 1.5 * HIGHEST, "but not on twice the mesh, share by share"
