"""One contact of a bearing in the laboratory: laws against Hertz' and their own formulas, cycles against closed forms."""

import json

import numpy as np
import pytest
from scipy.integrate import quad

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from checks.validation.figures import assert_readable
from raceway import RacewayError, SceneError

CUBIC = EXAMPLES.parent / "tests" / "cubic_law.py"
HUNT_CROSSLEY = EXAMPLES / "third_party_law" / "raceway_hunt_crossley" / "__init__.py"
FILM = ("contact.oil=VG 32", "contact.temperature_c=40", "kinematics.spin_speed_rpm=10000")
#: Means over equal samples of a smooth, closed cycle: rounding alone.
EXACT = 1e-10


@pytest.fixture
def hunt_crossley(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES / "third_party_law"))
    return lambda *changes, **options: rw.law("hunt_crossley", None, *changes, plugins=[HUNT_CROSSLEY], **options)


@pytest.mark.parametrize("race", ["inner", "outer"])
def test_hertz_is_hertz_and_stiffer_by_three_halves(race):
    found = rw.law("hertz", race=race)
    assert [row["force_ratio"] for row in found.rows] == pytest.approx([1.0] * 5, rel=1e-14)
    assert [row["stiffness_ratio"] for row in found.rows] == pytest.approx([1.0] * 5, rel=1e-14)
    for row in found.rows:
        assert row["stiffness"] == pytest.approx(1.5 * row["force"] / row["approach"], rel=1e-14)
    assert found.contact.load == pytest.approx(found.contact.hertz_factor * found.contact.approach**1.5, rel=1e-10)
    assert found.cycle.energy == found.cycle.damping == 0.0 and not found.damping.any()
    assert "no damping is modelled" in found.damping_origin


def test_the_contact_is_the_scenes():
    scene = rw.evolve(EXAMPLES / "b7206.toml", {"load": {"radial": [0.0, 300.0]}})
    balls = rw.run(rw.evolve(scene, "identifier.kind=tangent")).to_dict()["equilibrium"]["balls"]
    for race in ("inner", "outer"):
        loads = [ball[f"load_{race}_n"] for ball in balls]
        found = rw.law("hertz", scene, race=race).contact
        assert (found.ball, found.load) == (int(np.argmax(loads)), pytest.approx(max(loads), rel=1e-9))
        assert rw.law("hertz", scene, race=race, ball=2).contact.load == pytest.approx(loads[2], rel=1e-9)
    assert rw.law("hertz", scene).cycle.frequency == pytest.approx(200.0)  # 12 000 r/min


def test_other_laws_by_their_own_formulas():
    parabola, cubic = rw.law("penalty"), rw.law("cubic", plugins=[CUBIC])
    for power, found in ((2.0, parabola), (3.0, cubic)):
        for row in found.rows:
            assert row["stiffness"] == pytest.approx(power * row["force"] / row["approach"], rel=1e-12)
    assert cubic.rows[2]["force"] == pytest.approx(2e17 * cubic.contact.approach**3, rel=1e-12)
    assert cubic.rows[2]["force"] == pytest.approx(cubic.contact.load, rel=1e-9)


def test_a_film_stands_between_the_surfaces():
    """At the load of the equilibrium the surfaces are one central film thickness further apart than Hertz' are."""
    found = rw.law("film", None, *FILM).contact
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "contact": {"kind": "film", "oil": "VG 32", "temperature_c": 40.0},
             "kinematics": {"spin_speed_rpm": 10000.0}}  # fmt: skip
    thick = rw.run(scene).to_dict()["equilibrium"]["balls"][0]["inner_film_central_m"]
    assert found.approach == pytest.approx((found.load / found.hertz_factor) ** (2.0 / 3.0) - thick, rel=1e-6)
    assert found.at(-1.001 * found.reach)[0] == 0.0 < found.at(-0.999 * found.reach)[0]
    thin = rw.law("film", None, "contact.viscosity=1e-30", "kinematics.spin_speed_rpm=10000")
    assert [row["force_ratio"] for row in thin.rows] == pytest.approx([1.0] * 5, rel=1e-9)


def test_a_dashpot_costs_pi_c_w_x_squared():
    found = rw.law("hertz", None, "contact.damping=300", frequency=500.0)
    loop, w = found.cycle, 2.0 * np.pi * 500.0
    assert loop.energy == pytest.approx(np.pi * 300.0 * w * loop.amplitude**2, rel=EXACT)
    assert (loop.damping, loop.loss_factor) == pytest.approx((300.0, 300.0 * w / loop.stiffness), rel=EXACT)
    closed = found.approach > 1e-7
    # Its rate over the whole curve: 300 N s/m more where it closes, as much less where it opens.
    np.testing.assert_allclose((found.force[1] - found.force[2])[closed], 2.0 * 300.0 * found.rate[1], rtol=1e-9)


def test_a_time_constant_costs_pi_tau_k_w_x_squared_for_small_motions():
    """What is left falls with the square of the amplitude."""
    tau, off = 1e-5, []
    for amplitude in (0.2, 0.1):
        found = rw.law("hertz", None, f"contact.time_constant={tau}", amplitude=amplitude)
        loop, stiffness = found.cycle, found.rows[2]["stiffness"]
        small = np.pi * tau * stiffness * 2.0 * np.pi * loop.frequency * loop.amplitude**2
        off.append(loop.energy / small - 1.0)
    assert abs(off[0]) < 1e-2
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.02)


def test_a_third_partys_damped_law(hunt_crossley):
    """F = K d^1.5 (1 + c d'): W = c K w x^2 times the integral of (d_0 + x cos p)^1.5 sin^2 p over a turn."""
    found = hunt_crossley("contact.dissipation=0.05")
    loop, contact = found.cycle, found.contact
    turn = quad(lambda p: (contact.approach + loop.amplitude * np.cos(p)) ** 1.5 * np.sin(p) ** 2, 0.0, 2.0 * np.pi)[0]
    expected = 0.05 * contact.hertz_factor * 2.0 * np.pi * loop.frequency * loop.amplitude**2 * turn
    assert loop.energy == pytest.approx(expected, rel=1e-9)
    assert "hunt_crossley" in found.damping_origin
    assert found.damping[0].max() > 0.0


def test_a_laws_memory_is_carried_round_the_cycle(hunt_crossley):
    """c = 8 (1 - e) / (5 e v0) with v0 the speed at first touch, in a motion that opens the contact every time."""
    found = hunt_crossley("contact.restitution=0.8", amplitude=1.5, frequency=5000.0)
    loop, contact = found.cycle, found.contact
    w, x = 2.0 * np.pi * loop.frequency, loop.amplitude
    touch = w * np.sqrt(x**2 - contact.approach**2)
    turn = quad(lambda p: max(contact.approach + x * np.cos(p), 0.0) ** 1.5 * np.sin(p) ** 2, 0.0, 2.0 * np.pi)[0]
    expected = 8.0 * 0.2 / (5.0 * 0.8 * touch) * contact.hertz_factor * w * x**2 * turn
    # First touch is seen at the next of 720 samples per turn, and the law begins over 0.1 µm of roughness.
    assert loop.energy == pytest.approx(expected, rel=0.01)
    assert loop.opens


@pytest.mark.parametrize(
    ("name", "scene", "changes", "options", "told"),
    [
        ("hert", None, (), {}, "did you mean 'hertz'?"),
        ("hertz", None, (), {"race": "left"}, "`race` = 'left': must be one of inner, outer"),
        ("hertz", None, (), {"ball": 12}, "`ball` = 12: must be from 0 to 11"),
        ("hertz", None, (), {"amplitude": 0.0}, "`amplitude` = 0.0: must be a finite number, greater than 0"),
        ("hertz", None, (), {"frequency": float("nan")}, "`frequency` = nan: must be a finite number, greater than 0"),
        ("film", None, (), {}, "no viscosity is given"),
        ("film", None, ("contact.viscosity=0.03",), {}, "needs the running speed"),
        ("unilateral", None, (), {}, "supports 'nodal'"),
        ("hertz", None, ("bodies.kind=condensed",), {}, "use bodies.kind = 'rigid'"),
        ("hertz", None, ("contact.damping=band",), {}, "set contact.time_constant"),
        ("hertz", None, ("load.axial=50", "load.radial=[500, 0]"), {"ball": 6}, "ball 6 is unloaded at the inner race"),
    ],
)  # fmt: skip
def test_bad_input_is_told(name, scene, changes, options, told):
    with pytest.raises((SceneError, RacewayError)) as caught:
        rw.law(name, scene, *changes, **options)
    assert told in str(caught.value)


def test_the_command_says_what_the_function_does(tmp_path):
    words = ("dev", "law", "penalty", "--set", "contact.damping=300")
    found = invoke(*words, "--out", tmp_path, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    expected = rw.law("penalty", None, "contact.damping=300").to_dict()
    assert {key: content[key] for key in expected} == json.loads(json.dumps(expected))
    assert content == json.loads((tmp_path / "law.json").read_text())
    assert (tmp_path / "law.png").read_bytes()[:4] == b"\x89PNG"
    shown = " ".join(invoke(*words).stdout.split())
    assert f"{expected['cycle']['damping']:.4g} N s/m" in shown and "contact.damping: 300 N s/m at each contact" in shown
    third = invoke("dev", "law", "cubic", "--plugin", CUBIC)
    assert third.exit_code == 0 and "cubic: inner contact" in third.stdout


def test_its_pictures_are_readable():
    film = ("contact.viscosity=0.03", "kinematics.spin_speed_rpm=10000")
    found = [rw.law("penalty"), rw.law("hertz", None, "contact.damping=3000", amplitude=1.5), rw.law("film", None, *film)]
    assert_readable([one.draw() for one in found])
