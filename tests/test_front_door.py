"""What ``import raceway as rw`` offers: scenes in any form in, objects that show themselves out."""

import ast
import doctest
import inspect
import json
import re
import runpy
from functools import wraps
from html.parser import HTMLParser
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from raceway.extend import as_given
from raceway.testing import b7206c

SCENE = EXAMPLES / "b7206.toml"
TEXT = SCENE.read_text(encoding="utf-8")
STATIC = b7206c()
#: Names that are values: what they are stands in the package's own docstring.
VALUES = {"hookimpl", "LAW", "FORCE"}


@pytest.fixture(scope="module")
def forms():
    import tomllib

    return {"path": SCENE, "name": str(SCENE), "text": TEXT, "dict": tomllib.loads(TEXT), "Scene": rw.load_scene(SCENE)}


@pytest.mark.parametrize("form", ["path", "name", "text", "dict", "Scene"])
def test_a_scene_in_any_form_is_the_same(form, forms):
    assert rw.evolve(forms[form], "load.axial=400") == rw.load_scene(SCENE, ["load.axial=400"])
    assert rw.check(forms[form])
    assert rw.plan(forms[form]).to_dict() == rw.make_plan(rw.load_scene(SCENE)).to_dict() | {
        "predicted_wall_s": pytest.approx(rw.plan(SCENE).predicted_wall_s, rel=0.5)
    }


NO_SCENES = {
    "neither file nor text": ("b7206", "is neither a file nor the TOML text of a scene"),
    "missing file": (EXAMPLES / "b7207.toml", "no such file (did you mean 'b7206.toml'?)"),
    "no TOML": ("[load\naxial = 3", "is not valid TOML"), "empty": ("", "is empty"),
    "folder": (EXAMPLES, "is a folder; scenes in it"),
    "something else": (3, "must be a file, TOML text, a dict of tables or a Scene, not int"),
    "nothing": (None, "not NoneType"),
}  # fmt: skip


@pytest.mark.parametrize("case", NO_SCENES)
def test_what_is_no_scene_is_one_message(case):
    source, words = NO_SCENES[case]
    for door in (rw.run, rw.plan, rw.evolve):
        with pytest.raises(rw.SceneError) as caught:
            door(source)
        assert len(caught.value.mistakes) == 1
        assert words in str(caught.value)
    assert [words in one.message for one in rw.check(source).mistakes] == [True]


def test_every_mistake_of_a_dict_is_told():
    tables = b7206c(load={"axail": 3.0, "axial": "much"}, rotor={"mass": -1}, bearing={"rings": {"young": -1.0}})
    found = rw.check(tables)
    assert {one.path for one in found.mistakes} == {"load.axail", "load.axial", "rotor.mass", "bearing.rings.young"}
    with pytest.raises(rw.SceneError) as caught:
        rw.run(tables)
    assert caught.value.mistakes == list(found.mistakes)


def test_tables_are_merged_and_taken_out():
    scene = rw.Scene.from_toml(SCENE)
    changed = scene.with_(load={"axial": 400}, bearing={"rings": {"young": 200e9}}, rotor=None)
    assert changed.load.axial == 400.0
    assert changed.bearing.rings.young == 200e9 and changed.bearing.rings.density == scene.bearing.rings.density
    assert changed.rotor == rw.Scene.from_dict(b7206c()).rotor and changed.rotor != scene.rotor
    assert scene.with_(excitation=None).excitation is None
    assert scene.with_(load={"axial": 400}).with_(load={"axial": None}).load.axial == 0.0
    assert scene.load.axial == 1000.0, "the first scene stays as it is"
    with pytest.raises(rw.SceneError, match=r"load\.axail"):
        scene.with_(load={"axail": 3.0})
    with pytest.raises(rw.SceneError, match="`title` is not a table"):
        rw.evolve(scene, {"title.part": 3})
    with pytest.raises(rw.SceneError, match="must be text such as"):
        rw.evolve(scene, 3)


def test_another_preset_replaces_the_numbers_of_the_first():
    scene = rw.Scene.from_toml(SCENE).with_(bearing={"ball_count": 11})
    other = scene.with_(bearing={"preset": "B7206E"})
    assert other.bearing.ball_count == 11
    assert other.bearing.contact_angle_deg == rw.Scene.from_dict({"bearing": {"preset": "B7206E"}}).bearing.contact_angle_deg


def test_the_title_says_each_change_once():
    scene = rw.Scene.from_toml(SCENE)
    first = scene.title
    twice = scene.with_(load={"axial": 400}).with_(load={"axial": 500}, supports={"tilt": "free"})
    assert twice.title == f"{first}\nload.axial = 500, supports.tilt = free"
    assert scene.with_(title="mine").title == "mine"
    assert twice.title == rw.load_scene(SCENE, ["load.axial=500", "supports.tilt=free"]).title


def test_files_stay_where_the_scene_says(tmp_path, monkeypatch):
    (tmp_path / "inside").mkdir()
    (tmp_path / "inside" / "force.csv").write_text("t,Fy,Fz\n" + "".join(f"{k * 1e-4},{k % 7},0\n" for k in range(50)))
    tables = '[bearing]\npreset = "B7206C"\n[excitation]\nkind = "measured"\nspeed_rpm = 6000\nfile = "force.csv"\n'
    (tmp_path / "inside" / "scene.toml").write_text(tables)
    scene = rw.Scene.from_toml(tmp_path / "inside" / "scene.toml")
    monkeypatch.chdir(tmp_path)
    again = scene.with_(load={"axial": 400}).with_(excitation={"file": "force.csv"})
    assert Path(again.excitation.file) == Path(scene.excitation.file) == tmp_path / "inside" / "force.csv"


def test_what_was_said_is_kept_and_not_shared():
    tables = b7206c(load={"axial": np.float64(400.0), "radial": np.array([1.0, 2.0])}, bearing={"ball_count": np.int64(11)})
    scene = rw.Scene.from_dict(tables)
    tables["load"]["axial"] = 3.0
    assert scene.load.axial == 400.0 and scene.bearing.ball_count == 11
    assert as_given(scene).tables["load"] == {"axial": 400.0, "radial": [1.0, 2.0]}
    assert "ball_diameter" not in as_given(scene).tables["bearing"]
    json.dumps(scene.source)


@pytest.fixture(scope="module")
def moving():
    return rw.run(SCENE)


@pytest.fixture(scope="module")
def static():
    return rw.run(STATIC)


def test_numbers_of_a_result_are_those_of_the_file(moving, tmp_path):
    content = moving.to_dict()["identification"]
    assert moving.dynamic_stiffness == complex(*(content["dynamic_stiffness"][part] for part in ("real", "imag")))
    assert moving.equivalent_stiffness == content["equivalent_stiffness"]
    assert moving.equivalent_stiffness_error == content["equivalent_stiffness_error"] > 0.0
    assert moving.equivalent_damping == content["equivalent_damping"]
    assert moving.equivalent_damping_error == content["equivalent_damping_error"] > 0.0
    assert moving.orbit == (content["orbit"]["major_m"], content["orbit"]["minor_m"])
    assert moving.speed_rpm == pytest.approx(12000.0)
    balls = moving.to_dict()["equilibrium"]["balls"]
    assert moving.ball_loads.tolist() == [ball["load_inner_n"] for ball in balls]
    assert np.allclose(moving.stiffness, moving.stiffness.T, rtol=1e-6, atol=1.0)
    written = rw.run(STATIC, out=tmp_path / "here")
    assert json.loads((tmp_path / "here" / "result.json").read_text())["title"] == written.title


def test_a_static_result_has_no_stiffness_of_a_motion(static):
    for name in ("dynamic_stiffness", "equivalent_stiffness", "equivalent_stiffness_error", "orbit", "speed_rpm"):
        assert getattr(static, name) is None
    assert static.equivalent_damping is None and static.equivalent_damping_error is None
    # The outer balls' forces balance the load: axial parts of the contact forces add up to it.
    axial = static.ball_loads * np.sin(static.equilibrium.angle_inner)
    assert axial.sum() == pytest.approx(1000.0, rel=1e-6)


def test_a_folder_that_cannot_be_written_is_told_before_the_run(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("raceway.pipeline.run.run", lambda *_, **__: pytest.fail("computed"))
    with pytest.raises(rw.RacewayError, match="cannot be"):
        rw.run(STATIC, out=tmp_path / "file")


class Page(HTMLParser):
    """Text of a page, and whether its tags are closed in order."""

    def __init__(self, html):
        super().__init__()
        self.open, self.words = [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        if tag != "br":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def shown(moving, static):
    return {
        "result": moving, "static result": static, "scene": moving.model.scene,
        "scene with everything": rw.Scene.from_dict(rw.load_scene(SCENE).to_dict()),
        "plan": rw.plan(SCENE), "static plan": rw.plan(STATIC), "check": rw.check(SCENE),
        "mistakes": rw.check(b7206c(load={f"key_{k}": "x" * 300 for k in range(30)})),
    }  # fmt: skip


def test_every_object_shows_itself_in_15_lines_and_one_table(moving, static):
    for name, one in shown(moving, static).items():
        lines = repr(one).splitlines()
        assert 1 <= len(lines) <= 15, name
        assert max(map(len, lines)) <= 100, name
        page = Page(one._repr_html_())
        assert page.open == [] and one._repr_html_().count("<table") == 1
        first = lines[0].removesuffix(" ...")
        assert first in "".join(page.words)


def test_the_short_text_of_a_run_says_what_matters(moving, static):
    text = repr(moving)
    assert text.splitlines()[0] == moving.title
    low, high = moving.uncertainty["equivalent_stiffness"]["relative"]
    told = re.search(r"stiffness K +([\d.]+) N/µm +(\S+) to (\S+) %: ", text)
    assert float(told[1]) == pytest.approx(1e-6 * moving.equivalent_stiffness, rel=abs(low))
    assert [float(told[2]), float(told[3])] == pytest.approx([100.0 * low, 100.0 * high], abs=0.5)
    for word in ("damping C", "|Z|", "orbit", "error of Z", "B7206C", "cost"):
        assert word in text
    assert "stiffness K" not in repr(static) and "tangent kxx" in repr(static)


def test_a_number_below_its_error_is_none(moving):
    import attrs

    def with_total(size):
        return attrs.evolve(moving.errors, total=attrs.evolve(moving.errors.total, size=size))

    spoilt = attrs.evolve(moving, errors=with_total(2.0), warnings=("Z is not resolved",))
    assert re.search(r"stiffness K +not resolved", repr(spoilt))
    unknown = attrs.evolve(moving, errors=with_total(None))
    assert unknown.equivalent_stiffness_error is None
    assert re.search(r"error of Z +not estimated", repr(unknown))
    assert "1 warning" in repr(spoilt) and "Z is not resolved" in repr(spoilt)


def test_text_of_a_user_is_escaped_and_long_lists_are_counted():
    class Told(rw.Answer):
        def __init__(self, *facts):
            self.facts = facts

        def _facts(self):
            return self.facts

    html = Told("<b>\n& more", [("a<b", "1 < 2", "x & y")])._repr_html_()
    assert "<b>" not in html and "&lt;b&gt;" in html and "x &amp; y" in html
    text = repr(Told("T", [(f"name {k}", "v", "r" * 200) for k in range(40)]))
    assert len(text.splitlines()) == 15 and text.splitlines()[-1] == "  and 27 more"


def test_labelled_arrays_say_their_units(moving, static):
    data = moving.to_xarray()
    record = moving.simulation.record
    assert {"units", "long_name"} <= set(data.stiffness.attrs) and data.time.attrs["units"] == "s"
    assert all("units" in variable.attrs for variable in data.data_vars.values())
    assert data.stiffness.sel(dof="y", dof2="y").item() == moving.stiffness[1, 1]
    assert np.array_equal(data.motion.sel(dof="z"), record.displacement[:, 2])
    assert np.array_equal(data.contact_force.sel(race="outer"), record.contact_force[:, 12:])
    assert data.ball_load.sel(race="inner").values.tolist() == moving.ball_loads.tolist()
    assert data.azimuth.values == pytest.approx(30.0 * np.arange(12), abs=1e-9)
    assert np.array_equal(data.contact_angle.sel(race="outer"), np.degrees(moving.equilibrium.angle_outer))
    assert float(data.equivalent_stiffness) == moving.equivalent_stiffness
    assert "time" not in static.to_xarray().dims and "equivalent_stiffness" not in static.to_xarray()


def test_labelled_arrays_can_be_kept(moving, tmp_path):
    import xarray

    moving.to_xarray().to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as kept:
        assert kept.equals(moving.to_xarray())


def test_pictures_on_axes(moving, static, monkeypatch):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    assert moving.plot("orbit", ax=ax) is ax
    used = 1e6 * moving.simulation.record.displacement[:, 1]
    assert any(np.array_equal(line.get_xdata()[: used.size], used) for line in ax.lines)  # the orbit is drawn closed
    assert ax.get_xlabel() == "displacement y [µm]"
    assert len(moving.plot()) == 3 and len(static.plot()) == 1
    loads = moving.plot("ball_loads")
    assert loads.name == "polar" and np.array_equal(loads.lines[0].get_ydata()[:12], moving.ball_loads)
    # The 1x line of a circle has its radius.
    assert (
        moving.plot("spectrum").texts[0].get_text().startswith(f"1x: {1e6 * moving.identification.forward_amplitude:.4g} µm")
    )
    for what, given, words in (
        ("orbits", None, "did you mean 'orbit'"),
        ("ball_loads", ax, "needs polar axes"),
        (None, ax, "choose it by"),
    ):
        with pytest.raises(rw.RacewayError, match=words):
            moving.plot(what, ax=given)
    with pytest.raises(rw.RacewayError, match="no motion was recorded"):
        static.plot("orbit")
    pyplot.close("all")


@pytest.mark.parametrize(("module", "call"), [("xarray", "to_xarray"), ("matplotlib", "plot")])
def test_a_missing_library_is_one_message(static, monkeypatch, module, call):
    import sys

    for name in [name for name in sys.modules if name.partition(".")[0] == module]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(rw.RacewayError, match=rf"{module}, which is not installed: pip install"):
        getattr(static, call)()


@pytest.mark.parametrize(
    ("command", "called", "module"),
    [("run", "run", "pipeline.front"), ("plan", "check", "cli.plan"), ("check", "check", "cli.plan")],
)
def test_the_command_line_calls_the_same_function(command, called, module, monkeypatch, tmp_path):
    titles = []
    real = getattr(rw, called)

    @wraps(real)
    def watched(scene, **options):
        titles.append(scene.title)
        return real(scene, **options)

    monkeypatch.setattr(f"raceway.{module}.{called}", watched)
    words = ["--out", str(tmp_path)] if command == "run" else []
    assert invoke(command, SCENE, "--set", "excitation.speed_rpm=6000 rpm", *words).exit_code == 0
    assert titles == [rw.load_scene(SCENE, ["excitation.speed_rpm=6000"]).title]


#: Names whose examples draw with pyvista: the same.
DRAWN = {"view": [pytest.mark.needs("pyvista"), pytest.mark.slow], "View": [pytest.mark.needs("pyvista"), pytest.mark.slow]}


@pytest.mark.parametrize("name", [pytest.param(one, marks=DRAWN.get(one, ())) for one in rw.__all__])
def test_a_public_name_has_words_and_an_example_that_runs(name, monkeypatch):
    monkeypatch.chdir(EXAMPLES.parent)
    one = rw if name in VALUES else getattr(rw, name)
    text = inspect.getdoc(one) or ""
    assert len(text) > 40, f"{name} has no docstring"
    if name in VALUES:
        assert re.search(rf"^{name}  +\S", text, re.MULTILINE), f"{name} stands not in the package's docstring"
    finder, runner = doctest.DocTestFinder(recurse=inspect.isclass(one)), doctest.DocTestRunner()
    examples = [test for test in finder.find(one, name, globs={"math": __import__("math")}) if test.examples]
    assert examples, f"{name} has no example"
    for test in examples:
        runner.run(test)
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize(
    "name", ["Result", "Scene", "Check", "ScenePlan", "Comparison", "Precision", "Identified", "RossTable", "View"]
)
def test_what_an_object_has_is_documented(name):
    cls = getattr(rw, name)
    for word, member in inspect.getmembers(cls):
        if not word.startswith("_") and (isinstance(member, property) or inspect.isroutine(member)):
            assert inspect.getdoc(member), f"{name}.{word}"


def test_names_are_found_lazily_and_listed():
    assert rw.__all__ == dir(rw)
    with pytest.raises(AttributeError, match="module 'raceway' has no attribute 'rnu'"):
        _ = rw.rnu


def test_ten_lines_from_import_to_a_plot_of_k_over_speed(tmp_path, monkeypatch):
    script = EXAMPLES / "k_over_speed.py"
    code = ast.parse(script.read_text(encoding="utf-8")).body
    assert len([line for line in code if not isinstance(getattr(line, "value", None), ast.Constant)]) <= 10
    (tmp_path / "examples").symlink_to(EXAMPLES)
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("Agg")
    runpy.run_path(str(script))
    lines, x, y = [line.get_data() for line in plt.gca().lines], plt.gca().get_xlabel(), plt.gca().get_ylabel()
    plt.close("all")
    assert "r/min" in x and "N/µm" in y
    assert all((np.diff(speeds) > 0.0).all() for speeds, _ in lines)
    light, heavy = (np.array(values) for _, values in lines[:2])
    # At low speed K goes with the cube root of the load, the angle's change left out; faster balls open the angle, K falls.
    assert heavy[0] / light[0] == pytest.approx((1000 / 400) ** (1 / 3), rel=0.15)
    assert light[-1] < light[0] and (heavy > light).all()
    assert [path.stat().st_size > 10_000 for path in tmp_path.glob("*.png")] == [True]
