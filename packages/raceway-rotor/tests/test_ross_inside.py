"""Rolling bearings inside ROSS: what of them needs no ROSS, and what is said where it is missing; with ROSS the rest, too."""

import importlib
import subprocess
import sys
import types
from unittest import mock

import numpy as np
import pytest
from raceway_rotor.node_bearing import node_bearing, secant_stiffness
from raceway_rotor.ross_file import ross

import raceway as rw
from checks.validation.command_line import EXAMPLES
from raceway import RacewayError, SceneError
from raceway.extend import harmonic_load

SPEED = 12000.0 * np.pi / 30.0
UNITS = np.ones(2)


def scene(axial, force):
    turning = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": force}
    tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": axial}}
    return {**tables, "excitation": turning, "integrator": {"kind": "quasi_static"}}


def test_a_circle_changes_both_stiffnesses_alike_and_a_line_only_its_own():
    tangent, u = np.diag([3.0, 3.0]), np.array([1.0, -1.0j])
    np.testing.assert_allclose(secant_stiffness(tangent, u, 2.0 * u, UNITS), 2.0 * np.eye(2), atol=1e-14)
    line = np.array([1.0 + 2.0j, 0.0])
    np.testing.assert_allclose(secant_stiffness(tangent, line, 2.0 * line, UNITS), np.diag([2.0, 3.0]), atol=1e-14)


def test_a_secant_carries_the_motion_and_is_symmetric():
    random = np.random.default_rng(3)
    true = random.normal(size=(4, 4))
    true, tangent = true + true.T, np.diag([1.0, 2.0, 3.0, 4.0])
    u, units = random.normal(size=4) + 1j * random.normal(size=4), np.array([1.0, 1.0, 0.02, 0.02])
    assert node_bearing("B7206C", 1000.0, "node").units(SPEED) == pytest.approx(
        [1, 1, 0.023, 0.023], rel=0.2
    )  # half the pitch diameter
    found = secant_stiffness(tangent, u, true @ u, units)
    np.testing.assert_allclose(found @ u, true @ u, rtol=1e-10)
    np.testing.assert_allclose(found, found.T, rtol=1e-10)


@pytest.mark.parametrize("axial, force", [(1000.0, 904.9), (400.0, 933.7)])
def test_a_turning_load_meets_the_stiffness_of_a_run(axial, force):
    one, load = node_bearing("B7206C", axial), force * np.array([1.0, -1.0j])
    z = one.stiffness_on(SPEED, load, one.motion(SPEED, load))
    wanted = rw.run(scene(axial, force)).equivalent_stiffness
    # Both are the 1x line of the same equilibria.
    np.testing.assert_allclose(z[1:, 1:], wanted * np.eye(2), atol=1e-9 * wanted)


def test_a_load_turns_as_its_complex_amplitudes_do():
    amplitudes = np.array([5.0j, 3.0, -3.0j, 0.2 + 0.1j, 0.4])
    load, out = harmonic_load(SPEED, amplitudes), np.empty(5)
    for t in (0.0, 3e-4, 1e-3):
        load.kernel()(t, load.parameters(), out)
        assert out == pytest.approx((amplitudes * np.exp(1j * SPEED * t)).real)


@pytest.mark.parametrize("tilt", ["locked", "free", "node", 5e3])
@pytest.mark.parametrize("axial", ["force", "displacement"])
def test_the_force_has_the_stiffness_of_small_motions_as_derivative(tilt, axial):
    one = node_bearing({"bearing": {"preset": "B7206C"}, "load": {"radial": [150.0, 80.0]}}, 1000.0, tilt, axial)
    wanted = one.dynamic_stiffness(SPEED, SPEED).real
    assert wanted.shape == ((5, 5) if tilt == "node" else (3, 3))
    step = np.array([1e-8, 1e-8, 1e-8, 1e-6, 1e-6])[: one.size]
    moves = [h * row for h, row in zip(step, np.eye(one.size), strict=True)]
    changes = [one.resistance(SPEED, move)[0] - one.resistance(SPEED, -move)[0] for move in moves]
    found = np.transpose(changes) / (2.0 * step)
    scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    # Forces of 1e3 N to 1e-11 over 2e-8 m of 3e7 N/m, and the curvature of the force over 1e-8 m.
    np.testing.assert_allclose(found / scale, wanted / scale, atol=1e-5)
    np.testing.assert_allclose(one.resistance(SPEED, 0.0 * step)[1] / scale, wanted / scale, atol=1e-8)


def test_spacers_are_stiffer_than_springs():
    held, sprung = (node_bearing("B7206C", 400.0, axial=axial) for axial in ("displacement", "force"))
    q = np.array([0.0, 5e-6, 0.0])
    assert held.resistance(SPEED, q)[0][1] > 1.05 * sprung.resistance(SPEED, q)[0][1]


def test_contact_damping_is_in_c():
    one = node_bearing({"bearing": {"preset": "B7206C"}, "contact": {"damping": 100.0}}, 1000.0, damping=7.0)
    tables = {**scene(1000.0, 1.0), "contact": {"damping": 100.0}, "identifier": {"kind": "tangent"}}
    wanted = rw.run(tables).equivalent_damping + 7.0
    c = one.dynamic_stiffness(SPEED, SPEED).imag / SPEED
    assert c[1, 1] == pytest.approx(wanted, rel=1e-9)
    without = node_bearing({"bearing": {"preset": "B7206C"}, "contact": {"damping": 100.0}}, 1000.0)
    assert np.allclose(c - without.dynamic_stiffness(SPEED, SPEED).imag / SPEED, 7.0 * np.eye(3), atol=1e-6)


@pytest.mark.parametrize("given, words", [
    ({"bearing": "B7206G"}, "the nearest"),
    ({"bearing": {"bearing": {"preset": "B7206C"}, "contact": {"friction": 0.1}}}, "dissipates"),
    ({"bearing": "B7206C", "preload": 100.0, "damping": -1.0}, "must be a finite damping"),
    ({"bearing": "B7206C", "preload": 100.0, "tilt": "loose"}, "supports.tilt"),
])  # fmt: skip
def test_bad_input_is_refused(given, words):
    with pytest.raises(SceneError, match=words):
        node_bearing(**given)


def test_what_is_missing_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "ross", None)  # an import of it fails
    for name in ("raceway.ross", "raceway_rotor.bearing"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    with pytest.raises(RacewayError, match=r"RollingBearing needs ROSS: pip install './packages/raceway-rotor\[ross\]'"):
        _ = importlib.import_module("raceway.ross").RollingBearing


def test_an_old_ross_is_refused(monkeypatch):
    monkeypatch.setitem(sys.modules, "ross", types.SimpleNamespace(__version__="1.6.1"))
    with pytest.raises(RacewayError, match=r"needs ROSS 2.0 or later, and 1.6.1 is installed here"):
        ross("raceway.ross.RollingBearing")
    with pytest.raises(RacewayError, match=r"needs ROSS 3.0 or later"):
        ross("this", least=3)


def beside_an_empty_ross(name):
    """A module of the package that imports ROSS, which is not asked."""
    names = [f"raceway_rotor.{name}" for name in ("bearing", "responses")]
    with mock.patch.dict(sys.modules, {"ross": types.SimpleNamespace(__version__="3.0", BearingElement=object)}):
        for other in names:
            sys.modules.pop(other, None)
        return importlib.import_module(f"raceway_rotor.{name}")


@pytest.mark.parametrize("side", [1, -1])
def test_axes_are_turned_and_not_mirrored(side):
    """A bearing that faces -z is one turned half about X; tilts about y, z turn as y, z do, so that their coupling keeps its hand."""
    element = object.__new__(beside_an_empty_ross("bearing").RollingBearing)
    k, c = np.random.default_rng(4).normal(size=(2, 5, 5))
    own = types.SimpleNamespace(size=5, dynamic_stiffness=lambda w, speed: k + 1j * w * speed * c)
    element.side, element.n_link, element.node_bearing, element._at_motion = side, None, own, {}
    frame = element.frame
    assert frame[0].tolist() == [0, 0, side, 0, 0] and frame[1].tolist() == [1, 0, 0, 0, 0]  # X, Y, Z are y, z, x
    assert np.linalg.det(frame[:3, :3]) == pytest.approx(1.0) and not frame[:3, 3:].any() and not frame[3:, :3].any()
    np.testing.assert_array_equal(frame[3:, 3:], frame[1:3, :2])
    np.testing.assert_allclose(element.K(50.0, -20.0), frame.T @ k @ frame)
    np.testing.assert_allclose(element.C(50.0, -20.0), 20.0 * frame.T @ c @ frame)
    for name, column in element._table(np.array([3.0, 50.0])).items():
        row, place = ("xyz".index(letter) for letter in name[1:])
        assert column[1] == pytest.approx(getattr(element, name[0].upper())(50.0)[row, place])
    element.n_link = 7
    assert not (element.K(50.0) @ np.tile(np.eye(5), 2).T).any()  # no force where both nodes move alike


def test_an_unbalance_turns_with_the_shaft():
    """A free mass on springs under a force from X towards Y: m_u w^2 / (k - m w^2) of it, Y a quarter turn later; ROSS is not asked."""
    balance = beside_an_empty_ross("responses")._Balance
    k, m, w, none = 1e7, 2.0, 500.0, np.zeros((3, 3))
    machine = types.SimpleNamespace(
        K=lambda _: k * np.eye(3), M=lambda _: m * np.eye(3), C=lambda _: none, G=lambda: none, ndof=3, number_dof=3
    )
    held = types.SimpleNamespace(moving=[1, 2], dynamic_stiffness=lambda *_: none)
    bearing = types.SimpleNamespace(node_bearing=held, frame=np.eye(3)[[2, 0, 1]], dofs=[0, 1, 2])
    found = balance.at(machine, [bearing], w, (0, 1e-4, 0.3))
    size = 1e-4 * w**2 / (k - m * w**2) * np.exp(0.3j)
    np.testing.assert_allclose(found.response, size * np.array([1.0, -1.0j]), rtol=1e-12)
    np.testing.assert_allclose(found.receptance, np.eye(2) / (k - m * w**2), rtol=1e-12)


def test_the_bearing_s_force_is_that_at_the_end_of_a_step_of_a_gyroscopic_rotor():
    """Newmark's steps as ROSS takes them, with a force of k x + k_3 x^3: k x less that is on the right-hand side."""
    k, k3, w, dt, eye, gyro = (
        1e6, 1e14, 300.0, 1e-4, np.eye(3),
        np.array([[0.0, 0.8, 0.0], [-0.8, 0.0, 0.0], [0.0, 0.0, 0.0]]),
    )  # fmt: skip
    own = types.SimpleNamespace(
        size=3,
        dynamic_stiffness=lambda *_: k * eye,
        resistance=lambda _, q: (k * q + k3 * q**3, np.diag(k + 3.0 * k3 * q**2)),
    )
    machine = types.SimpleNamespace(K=lambda _: k * eye, M=lambda: eye, C=lambda _: 100.0 * eye, G=lambda: gyro, ndof=3)
    turns, damping = w * dt * np.arange(50), 100.0 * eye + w * gyro
    forces = 100.0 * np.column_stack([np.cos(turns), np.sin(turns), 0.0 * turns])
    bearing = types.SimpleNamespace(node_bearing=own, frame=eye, dofs=[0, 1, 2])
    extra = beside_an_empty_ross("responses")._NonlinearForce(machine, [bearing], w, forces, 0.5, 0.25)
    y, v, a = np.zeros(3), np.zeros(3), forces[0]
    for n in range(1, len(forces)):
        added = extra(n, time_step=dt, disp_resp=y, velc_resp=v, accl_resp=a)
        y, v = y + dt * v + 0.25 * dt**2 * a, v + 0.5 * dt * a
        a = np.linalg.solve(eye + 0.5 * dt * damping + 0.25 * dt**2 * k * eye, forces[n] + added - k * y - damping @ v)
        y, v = y + 0.25 * dt**2 * a, v + 0.5 * dt * a
        assert added == pytest.approx(-k3 * y**3, rel=1e-8, abs=1e-6)  # solved to 1e-10 of the displacement
    assert np.abs(k3 * y**3).max() > 5.0  # of 100 N


def test_the_example_is_short_and_says_what_is_missing(tmp_path):
    example = EXAMPLES / "ross_rotor.py"
    assert len(example.read_text(encoding="utf-8").splitlines()) <= 25
    (tmp_path / "ross.py").write_text("raise ImportError('not here')\n", encoding="utf-8")
    code = f"import sys, runpy; sys.path.insert(0, {str(tmp_path)!r}); runpy.run_path({str(example)!r})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1 and "needs ROSS" in done.stderr and "Traceback" not in done.stderr


@pytest.fixture(scope="module")
def program():
    return ross("this test")


def rotor(program, axial, **options):
    from raceway.ross import RollingBearing

    steel = program.Material(name="steel", rho=7810.0, E=2.1e11, G_s=8.1e10)
    shaft = [program.ShaftElement(L=0.05, idl=0.0, odl=0.03, material=steel) for _ in range(6)]
    disc = program.DiskElement(n=3, m=3.0, Id=4.1e-3, Ip=8.05e-3)
    ends = [RollingBearing("B7206C", sign * axial, n=node, **options) for sign, node in ((1.0, 0), (-1.0, 6))]
    return program.Rotor(shaft, [disc], ends)


@pytest.mark.ross
@pytest.mark.parametrize("tilt", ["locked", "node"])
def test_the_response_of_ross_carries_the_loads_of_the_bearings(program, tilt):
    from raceway.ross import run_unbalance_response

    machine = rotor(program, 400.0, tilt=tilt)
    before = np.asarray(machine.run_unbalance_response(3, 6.39e-4, 0.0, [SPEED]).forced_resp)
    found = run_unbalance_response(machine, 3, 6.39e-4, 0.0, [SPEED])
    after = np.asarray(machine.run_unbalance_response(3, 6.39e-4, 0.0, [SPEED]).forced_resp)
    np.testing.assert_array_equal(before, after)  # the rotor itself keeps K of small motions
    for one in machine.bearing_elements:
        moved = np.asarray(found.response.forced_resp)[one.dofs, 0]
        held = found.rotor.bearing_elements[0 if one.n == 0 else 1]
        force = (held.K(SPEED) + 1j * SPEED * held.C(SPEED)) @ moved
        # The balance is solved to 1e-7.
        size = np.abs(found.force[one.tag][0]).max()
        np.testing.assert_allclose(force, found.force[one.tag][0], atol=1e-5 * size)
        own = one.node_bearing.motion(SPEED, (one.frame @ found.force[one.tag][0])[one.node_bearing.moving])
        np.testing.assert_allclose(own, (one.frame @ moved)[one.node_bearing.moving], atol=1e-5 * np.abs(own).max())


@pytest.mark.ross
def test_what_no_bearing_can_be_is_refused(program):
    from raceway.ross import RollingBearing, run_time_response, run_unbalance_response

    for words, options in (
        ("must be an axial load", {"preload": 0.0}),
        ("ROSS links translations only", {"tilt": "node", "n_link": 7}),
    ):
        with pytest.raises(SceneError, match=words):
            RollingBearing("B7206C", **{"preload": 400.0, "n": 0, **options})
    machine = rotor(program, 400.0)
    with pytest.raises(RacewayError, match="greater than 0"):
        run_unbalance_response(machine, 3, 6.39e-4, 0.0, [0.0])
    t = np.linspace(0.0, 1e-3, 5)
    for words, speed, options in (("of one speed", t, {}), ("newmark_type", SPEED, {"newmark_type": "robust"})):
        with pytest.raises(RacewayError, match=words):
            run_time_response(machine, speed, np.zeros((5, machine.ndof)), t, **options)


@pytest.mark.ross
def test_a_table_is_saved_for_a_ross_without_raceway(program, tmp_path):
    from raceway.ross import RollingBearing

    one = RollingBearing("B7206C", 1000.0, n=0)
    one.save(tmp_path / "bearing.toml")
    read = program.BearingElement.load(tmp_path / "bearing.toml")
    axis = one.speed if getattr(one, "speed", None) is not None else one.frequency
    np.testing.assert_allclose(read.K(axis[2]), one.K(axis[2]), rtol=1e-6, atol=1.0)
