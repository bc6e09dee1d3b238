"""Several steady motions under one force: the stable one is taken, all are told, by every integrator alike."""

from __future__ import annotations

from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from raceway import scene_from_dict
from raceway.commands.screen.result import run_screen
from raceway.core.periodic import beginning
from raceway.errors import ConvergenceError
from raceway.run import run
from tests.reference.ring import Ring
from tests.reference.shooting import dynamic_stiffness, rotating, swinging, trajectory

W = 15000.0 * np.pi / 30.0


class Damped(Ring):
    """A ring whose damping is a dashpot along x, y and z [N s/m], not one in each contact."""

    def damping_matrix(self, q):
        return np.diag([self.damping, self.damping, self.damping, 0.0, 0.0])


def heavy(mass, damping=5000.0, **integrator):
    """1000 N axial, 100 N that turn at 15 000 r/min, near resonance: the contacts soften."""
    return {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 1000.0},
        "rotor": {"mass": mass, "damping": damping},
        "excitation": {"kind": "bidirectional", "speed_rpm": 15000, "amplitude": "constant", "force": 100.0},
        "contact": {"damping": 0.0},
        "integrator": integrator,
    }


def article(axial, **integrator):
    """The article's scene, its force in one direction and the same at every speed, tilt free."""
    return {
        "bearing": {"preset": "B7206C"},
        "supports": {"tilt": "free"},
        "rotor": {"mass": 2.0},
        "load": {"axial": axial},
        "excitation": {"kind": "unidirectional", "speed_rpm": 15000, "amplitude": "constant", "unbalance": 6.39e-4,
                       "load_share": 0.5, "reference_speed_rpm": 10980.0},
        "contact": {"damping": 0.0},
        "integrator": integrator,
    }  # fmt: skip


def solved(tables):
    return run(scene_from_dict(tables))


def z_of(one):
    return complex(one["dynamic_stiffness"]["real"], one["dynamic_stiffness"]["imag"])


def by_integration(result, damping=0.0):
    """Z and the largest multiplier of a turn that an integration of its own begins on the motion; it must close."""
    model, record = result.model, result.simulation.whole
    ring = Damped(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522, spin_speed=W, damping=damping)
    force = (rotating if model.excitation.sense else swinging)(model.excitation.amplitude_n, W)
    times = np.linspace(0.0, 2.0 * np.pi / W, 181)
    mass, load, free = model.system.mass, model.system.load, model.system.free
    begin = record.displacement[-1], record.velocity[-1]
    q, _, flow = trajectory(ring, mass, load, force, free, *begin, times, 1e-10, variational=True)
    assert np.abs(q[-1] - q[0])[:3].max() < 1e-7 * np.ptp(q[:, 1])
    return dynamic_stiffness(times[:-1], q[:-1], force, W), np.abs(np.linalg.eigvals(flow)).max()


def test_the_stable_motion_beyond_a_fold():
    """82 kg: the motion that grows out of rest turns back below the whole force; no transient of 12 turns finds the other."""
    result = solved(heavy(82.0, kind="periodic", tolerance=1e-9))
    z = result.identification.dynamic_stiffness
    wanted, multiplier = by_integration(result, 5000.0)
    assert abs(z - wanted) < 1e-6 * abs(wanted)
    assert multiplier == pytest.approx(result.simulation.orbits[0]["multiplier"], abs=1e-6)
    assert multiplier < 1.0
    by_time = solved(heavy(82.0))
    assert by_time.simulation.start.kind == "orbit"
    assert abs(by_time.identification.dynamic_stiffness - z) < 2.0 * by_time.error["total"] * abs(z)
    assert by_time.error["total"] < 1e-3


@pytest.mark.parametrize("kind", ["periodic", "newmark"])
def test_two_stable_motions_are_told(kind):
    """80 kg: between the folds."""
    result = solved(heavy(80.0, kind=kind))
    told = result.as_dict()["motion"]["orbits"]
    lasting = [one for one in told if one["stable"]]
    assert len(lasting) == 2 and len(told) == 3
    assert [one["taken"] for one in told] == [True, False, False]
    assert abs(z_of(told[0]) - result.identification.dynamic_stiffness) < 1e-3 * abs(z_of(told[0]))
    assert min(one["multiplier"] for one in told if not one["stable"]) > 1.2
    assert any("2 steady motions" in text for text in result.warnings)
    with (console := Console(width=200, file=StringIO())).capture() as shown:
        console.print(run_screen(result.as_dict(), []))
    words = shown.get()
    assert "Steady motions that were found" in words and "-7.5481 + 7.854j" in words


def test_without_damping_the_branch_leads_through_no_force():
    """The motion opposite in phase is the one that the branch meets at the opposite force, half a turn later."""
    result = solved(heavy(82.0, damping=0.0, kind="periodic", tolerance=1e-9))
    wanted, _ = by_integration(result)
    assert wanted.real < 0.0
    assert abs(result.identification.dynamic_stiffness - wanted) < 1e-6 * abs(wanted)


def test_an_internal_resonance_does_not_hide_the_stable_motion():
    """Newton's iteration from the linear response ends on an unstable motion; the force that grows leads to another one."""
    result = solved(article(1000.0, kind="periodic", tolerance=1e-9))
    first, second = result.simulation.orbits
    wanted, multiplier = by_integration(result)
    z = result.identification.dynamic_stiffness
    assert abs(z - wanted) < 1e-6 * abs(wanted)
    assert multiplier == pytest.approx(1.0, abs=1e-5)  # no damping
    assert (first["found"], second["found"]) == ("from rest", "directly")
    assert second["multiplier"] == pytest.approx(1.42, abs=0.01) and not second["stable"]
    by_time = solved(article(1000.0))
    assert abs(by_time.identification.dynamic_stiffness - z) < 2.0 * by_time.error["total"] * abs(z)


def test_a_transient_on_an_unstable_orbit_says_so():
    result = solved(article(800.0, turns=60))
    (only,) = result.simulation.orbits
    assert only["multiplier"] == pytest.approx(1.176, abs=0.001)
    assert any("unstable" in text and "1.176 times a turn" in text for text in result.warnings)
    assert result.error["transient"] >= result.identification.spread > 1e-3


def test_turns_that_do_not_repeat_after_a_failed_search_have_no_error(monkeypatch):
    """The ramp of 12 turns is on its way from one motion to another: its windowed lines agree to 3 %, its Z is off by 120 %."""

    def none(*_):
        raise ConvergenceError("none is found")

    monkeypatch.setattr(beginning, "beginning", none)
    result = solved(heavy(82.0))
    assert result.simulation.start.kind == "ramp"
    assert result.error["total"] is None and "do not repeat" in result.error["how"]["total"]
    assert result.error["transient"] >= result.identification.spread > 0.01


def test_a_near_linear_motion_is_told_alone():
    result = solved(heavy(20.0))
    (only,) = result.simulation.orbits
    assert only["taken"] and only["verdict"] == "stable" and only["found"] == "directly"
    assert not any("motion" in text for text in result.warnings)


def test_with_friction_orbits_are_no_motions_of_the_scene():
    tables = heavy(80.0)
    tables["contact"]["friction"] = 0.03
    result = solved(tables)
    assert result.simulation.orbits == []
    assert any(text.startswith("without friction: 2 steady motions") for text in result.warnings)
