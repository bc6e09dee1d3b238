"""Numbers of plug-ins: in results and functions, of one point and of columns, along a motion; what breaks a duty is named."""

import json
from typing import ClassVar

import attrs
import numpy as np
import pytest

import raceway as rw
from raceway import PluginError, Quantity, SceneError, hookimpl, option
from raceway.extend import default_registry

SCENE = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "kinematics": {"spin_speed_rpm": 6000.0}}
BALLS = {"ball_diameter": 9.5e-3, "pitch_diameter": 46e-3, "ball_count": 9, "width": 16e-3, "radial_clearance": 1e-5}
BALLS |= {"conformity_inner": 0.52, "conformity_outer": 0.52}
TURNING = {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 2e-4}


@attrs.frozen
class Loads:
    """Mean load of the inner contacts, and their loads over a turn of the motion."""

    name: ClassVar[str] = "loads"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        Quantity("mean_load", "N", "mean load of the inner contacts over a scale", "loads.mean"),
        Quantity("turn_load", "N", "over a turn", "loads.turn", dims=("instant", "race", "ball")),
    )

    scale: float = option(1.0, help="that loads are divided by")

    def why_not(self, problem):
        return "" if problem.load.axial else "load.axial"

    def turn_samples(self, problem):
        return 12

    def compute(self, points):
        turn = points.load[:, None] if points.turn is None else points.turn(12)
        return {"mean_load": points.load[:, 0].mean(axis=1) / self.scale, "turn_load": turn}

    def warnings(self, points, values):
        return ["loads are large"] if values["mean_load"][0] > 200.0 else []


def registered(plugin):
    """A module that hands the class in."""

    @hookimpl
    def raceway_quantities():
        return [plugin]

    module = type("Module", (), {})()
    module.raceway_quantities = raceway_quantities
    return module


@pytest.fixture
def use():
    """Registers a class for a test."""
    registry, modules = default_registry(), []

    def add(plugin):
        modules.append(registered(plugin))
        registry.add(modules[-1], f"test {plugin.name}")

    yield add
    for module in modules:
        registry.manager.unregister(module)
    registry._forget([e for e in registry.all() if e.source.startswith("test ")])


@pytest.fixture
def loads(use):
    use(Loads)


def test_a_run_states_them_with_options_warnings_and_a_table(loads):
    result = rw.run({**SCENE, "quantities": {"loads": {"scale": 2.0}}})
    mean = result.ball_loads.mean()
    assert result.quantities["mean_load"] == pytest.approx(mean / 2.0, rel=1e-14)
    tables = json.loads(json.dumps(result.to_dict()))
    assert tables["loads"]["mean"] == result.quantities["mean_load"]
    assert tables["scene"]["quantities"] == {"loads": {"scale": 2.0}}
    assert "loads are large" not in result.warnings and "loads are large" in rw.run(SCENE).warnings


def test_a_function_computes_them_as_columns(loads):
    forces = np.array([400.0, 1000.0])
    f = rw.function(SCENE, ["load.axial", "quantities.loads.scale"], ["mean_load", "bpfo"])
    answer = f(forces, 4.0)
    for k, force in enumerate(forces):
        result = rw.run({**SCENE, "load": {"axial": force}})
        assert answer["mean_load"][k] == pytest.approx(result.ball_loads.mean() / 4.0, rel=1e-9)
        assert answer["bpfo"][k] == pytest.approx(result.quantities["bpfo"], rel=1e-9)
    assert f.jacobian(1000.0, 4.0)["mean_load"]["quantities.loads.scale"] == pytest.approx(
        -answer["mean_load"][1] / 4.0, rel=1e-6
    )


@pytest.mark.parametrize("radial", [0.0, 300.0])
def test_forces_over_a_turn_are_those_of_a_run(loads, radial):
    """A turn of the orbit as columns is a trigonometric polynomial; a run has it at 360 times, among them these 12."""
    scene = {**SCENE, "load": {"axial": 1000.0, "radial": [radial, 0.0]}, "excitation": TURNING}
    turn = rw.function(scene, ["load.axial"], ["turn_load"])([400.0, 1000.0])["turn_load"][1]
    assert turn == pytest.approx(rw.run(scene).quantities["turn_load"], rel=1e-8)
    assert np.ptp(turn[:, 0, 0]) > 50.0


@attrs.frozen
class Renamed(Loads):
    """The same numbers under another name."""

    name: ClassVar[str] = "renamed"


def test_two_plugins_with_one_number_are_refused(loads, use):
    use(Renamed)
    with pytest.raises(PluginError, match="'mean_load' has the name of another quantity"):
        rw.function(SCENE, ["load.axial"], ["mean_load"])


@attrs.frozen
class Broken(Loads):
    """Forgets a number."""

    name: ClassVar[str] = "broken"

    def compute(self, points):
        return {"mean_load": 1.0}


@attrs.frozen
class Shapeless(Loads):
    """Numbers without the points' axis."""

    name: ClassVar[str] = "shapeless"

    def compute(self, points):
        return {"mean_load": 1.0, "turn_load": 1.0}


@pytest.mark.parametrize(("plugin", "words"), [
    (Broken, "'broken': compute.. must return exactly its `numbers`.*turn_load"),
    (Shapeless, r"turn_load. has shape \(1,\), not \(1, instant, race, ball\)"),
])  # fmt: skip
def test_a_broken_duty_is_named(use, plugin, words):
    use(plugin)
    with pytest.raises(PluginError, match=words):
        rw.run(SCENE)


def test_what_a_scene_lacks_is_said(loads):
    scene = {**SCENE, "load": {"axial": 0.0, "radial": [500.0, 0.0]}, "bearing": {**BALLS}}
    with pytest.raises(SceneError, match=r"mean_load.*is not a number of this scene: load\.axial"):
        rw.function(scene, ["load.radial[0]"], ["mean_load"])
    with pytest.raises(SceneError, match=r"quantities\.load.*did you mean 'loads'"):
        rw.run({**SCENE, "quantities": {"load": {}}})


def test_bands_of_samples_have_them(loads):
    """All balls carry the same share of an even axial load of 900 to 1100 N, at an angle that moves little."""
    band = rw.band(SCENE, {"load.axial": "±10 %"}, count=64)
    mean = band.nominal["mean_load"]
    assert mean == pytest.approx(rw.run(SCENE).quantities["mean_load"], rel=1e-9)
    assert band.high["mean_load"] / mean == pytest.approx(1.095, abs=0.02) and band.low["mean_load"] < mean
    assert band.to_dict()["quantities"]["mean_load"]["unit"] == "N"


def test_a_band_to_first_order_has_them(loads):
    """Of a number that a key moves in proportion, the derivative is that number over the key's; a key of the plug-in acts, too."""
    scene = rw.evolve(SCENE, {"quantities": {"loads": {"scale": 2.0}}})
    tolerances = {"load.axial": "+-1 %", "quantities.loads.scale": "+-2 %"}
    band = rw.run(rw.evolve(scene, {"tolerances": tolerances})).to_dict()["tolerances"]["quantities"]["mean_load"]
    near = [float(rw.function(scene, ["load.axial"], ["mean_load"])(load)["mean_load"]) for load in (999.0, 1001.0)]
    widths = 20.0 * (near[1] - near[0]) / 2.0, 0.04 * band["value"]
    assert band["unit"] == "N" and band["definition"].startswith("mean load of the inner contacts")
    assert band["shares"]["load.axial"] == pytest.approx(widths[0] ** 2 / (widths[0] ** 2 + widths[1] ** 2), rel=1e-5)
    sampled = rw.band(scene, tolerances, count=256)
    assert [band["low"], band["high"]] == pytest.approx([sampled.low["mean_load"], sampled.high["mean_load"]], rel=2e-3)


def test_a_fit_takes_them_as_measured(loads):
    angle, axial = 17.0, [400.0, 800.0, 1500.0]
    steep = rw.evolve(SCENE, {"bearing.contact_angle_deg": angle})
    measured = rw.function(steep, ["load.axial"], ["mean_load"])(axial)["mean_load"]
    fitted = rw.fit({"load.axial [N]": axial, "mean_load [N]": measured}, SCENE, free=["bearing.contact_angle_deg"])
    assert fitted.estimate.values[0] == pytest.approx(angle, rel=1e-6)


def test_sweeps_and_tables_of_coefficients_have_them(tmp_path):
    lines = ["from raceway import hookimpl", "from tests.test_quantities import Loads", "", "@hookimpl"]
    (tmp_path / "loads.py").write_text("\n".join([*lines, "def raceway_quantities():", "    return [Loads]", ""]))
    speeds = {"kinematics.spin_speed_rpm": [3000.0, 6000.0, 9000.0]}
    swept = rw.sweep(SCENE, speeds, plugins=[tmp_path / "loads.py"])
    table, content = (rw.export_coefficients(swept, source="tangent", kind=kind).text for kind in ("csv", "json"))
    expected = swept["mean_load"].values.tolist()
    assert json.loads(content)["quantities"]["mean_load [N]"] == expected and swept["mean_load"].units == "N"
    head, *rows = [line.split(",") for line in table.splitlines() if not line.startswith("#")]
    assert [float(row[head.index("mean_load [N]")]) for row in rows] == expected


@pytest.mark.slow
def test_the_page_of_a_bearing_has_them(loads):
    page = rw.view(SCENE, page=True).pictures["view.html"].decode()
    expected = rw.run(SCENE).quantities["mean_load"]
    assert "Mean load of the inner contacts, and their loads over a turn" in page and f"{expected:.5g}" in page
