"""Stores of sweeps: what is chosen of them, what is drawn, what ``raceway sweep`` and ``raceway export`` write."""

import json

import numpy as np
import pytest

from checks.validation.command_line import invoke
from checks.validation.stores import SPEEDS, as_list, made, stiffness
from raceway import RacewayError, SceneError
from raceway.extend import LIST, parse_at, select
from raceway.points.plot import draw, layout

SPEED, LOAD = "excitation.speed_rpm", "load.axial"
MANY = np.linspace(200.0, 2000.0, 9)
AXES = {SPEED: SPEEDS, LOAD: [2000.0, 400.0, 1000.0]}


def chosen(axes, at=None, **wanted):
    return layout(select(made(axes), at or {}), **wanted)


@pytest.mark.parametrize("axes, kind, x, y, panels", [
    ({SPEED: SPEEDS}, "curves", SPEED, None, None),
    ({LOAD: [400.0, 1000.0], SPEED: SPEEDS}, "curves", SPEED, LOAD, None),
    ({LOAD: MANY, SPEED: SPEEDS}, "map", SPEED, LOAD, None),
    ({LOAD: MANY, "supports.tilt": ["free", "locked"]}, "curves", LOAD, "supports.tilt", None),
    ({LOAD: MANY[:3], "supports.tilt": ["free", "locked"], SPEED: SPEEDS}, "curves", SPEED, "supports.tilt", LOAD),
    ({"supports.tilt": ["free", "locked"]}, "curves", "supports.tilt", None, None),
])  # fmt: skip
def test_defaults_follow_the_axes(axes, kind, x, y, panels):
    found = chosen(axes)
    assert (found.kind, found.x, found.y, found.panels) == (kind, x, y, panels)
    assert found.name == "equivalent_stiffness"
    draw(found)


def test_curves_hold_the_numbers_in_readable_units():
    axes = draw(chosen({SPEED: SPEEDS, LOAD: [400.0, 1000.0]})).axes[0]
    assert [line.get_label() for line in axes.lines] == ["400", "1000"]
    for line, load in zip(axes.lines, (400.0, 1000.0), strict=True):
        np.testing.assert_array_equal(line.get_xdata(), SPEEDS)
        np.testing.assert_allclose(line.get_ydata(), stiffness(SPEEDS, load) * 1e-6, rtol=1e-15)  # one product
    assert axes.figure.axes[-1].get_xlabel() == "speed [r/min]"
    assert axes.get_ylabel() == "equivalent stiffness [N/µm]"


@pytest.mark.parametrize("kind", ["map", "surface"])
def test_maps_and_surfaces_have_both_axes_with_units(kind):
    axes = draw(chosen({SPEED: SPEEDS, LOAD: MANY}, kind=kind)).axes
    assert (axes[0].get_xlabel(), axes[0].get_ylabel()) == ("speed [r/min]", "axial load [N]")
    value = axes[0].get_zlabel() if kind == "surface" else axes[1].get_ylabel()
    assert value == "equivalent stiffness [N/µm]"


def test_chosen_values_and_points_without_result_stand_in_the_picture():
    data = made({SPEED: SPEEDS, LOAD: [400.0, 1000.0]})
    data["equivalent_stiffness"][2, 0] = np.nan
    data["status"][2, 0] = "failed"
    picture = layout(select(data, {LOAD: 400.0}))
    assert picture.remark == "load.axial = 400; without result: 1 failed"
    figure = draw(picture)
    assert "without result: 1 failed" in figure.get_suptitle()
    assert np.isnan(figure.axes[0].lines[0].get_ydata()[2])


def test_a_list_is_drawn_as_points():
    data = as_list(made({SPEED: SPEEDS, LOAD: MANY})).isel(point=slice(0, 50))
    for kind in ("curves", "map"):
        draw(layout(select(data, {}), kind=kind))
    with pytest.raises(RacewayError, match="fill no grid, which a surface needs"):
        layout(select(data, {}), kind="surface")


def test_entries_of_arrays_have_their_own_unit():
    picture = chosen({SPEED: SPEEDS}, value="stiffness:y,y")
    assert picture.data.attrs["units"] == "N/m"
    assert chosen({SPEED: SPEEDS}, value="stiffness:tilt_y,tilt_y").data.attrs["units"] == "N m/rad"
    assert [chosen({SPEED: SPEEDS}, value=symbol).name for symbol in ("kxx", "kyy")] == ["stiffness:x,x", "stiffness:y,y"]
    np.testing.assert_array_equal(picture.data, np.full(len(SPEEDS), 2e8))


@pytest.mark.parametrize("axes, wanted, words", [
    (AXES, {"at": {"load.axail": 400.0}}, "is not an axis of this sweep (did you mean 'load.axial'?)"),
    (AXES, {"at": {LOAD: 500.0}}, "is not in the sweep, which has 400, 1000, 2000"),
    (AXES, {"at": {LOAD: 1000.5}}, "is not in the sweep"), (AXES, {"at": {LOAD: "many"}}, "is not in the sweep"),
    ({SPEED: SPEEDS}, {"value": "p1"}, "is not a quantity of this sweep"),
    ({SPEED: SPEEDS}, {"value": "stiffness"}, "takes 2 labels after a colon, for instance stiffness:y,y; 0 given"),
    ({SPEED: SPEEDS}, {"value": "stiffness:y,v"}, "has no 'v'"), ({SPEED: SPEEDS}, {"value": "p0:y"}, "takes 0 labels"),
    ({SPEED: SPEEDS, LOAD: MANY}, {"x": "load.axail"}, "is not an axis of this sweep (did you mean 'load.axial'?)"),
    ({SPEED: SPEEDS, LOAD: [400.0]}, {"x": LOAD}, "has the one value 400 here"),
    ({SPEED: SPEEDS, LOAD: MANY}, {"x": LOAD, "y": LOAD}, "is the axis of --x already"),
    ({SPEED: SPEEDS}, {"kind": "map"}, "takes two axes with numbers, and only excitation.speed_rpm varies"),
    ({SPEED: SPEEDS, "supports.tilt": ["free", "locked"]}, {"kind": "map", "y": "supports.tilt"}, "has words as values"),
    ({SPEED: SPEEDS, LOAD: MANY, "contact.damping": MANY[:7]}, {"kind": "curves"}, "choose one with --at"),
    ({SPEED: SPEEDS[:1]}, {}, "nothing varies in this part of the sweep"),
])  # fmt: skip
def test_what_cannot_be_drawn_is_refused_with_the_way_out(axes, wanted, words):
    with pytest.raises(RacewayError) as told:
        chosen(axes, **wanted)
    assert words in str(told.value)


def test_a_sweep_with_nothing_done_says_so():
    empty = made({SPEED: SPEEDS})
    empty = empty.drop_vars([name for name in empty.data_vars if name != "status"])
    for value in (None, "p0"):
        with pytest.raises(RacewayError, match="no point is done yet.*--resume"):
            layout(select(empty, {}), value)


def test_files_are_whole_repeatable_and_named_by_their_ending(tmp_path):
    picture = chosen({SPEED: SPEEDS})
    png = picture.write(tmp_path / "a.png").read_bytes()
    assert png.startswith(b"\x89PNG") and png.endswith(b"IEND\xaeB`\x82")
    for form, end in (("svg", b"</svg>"), ("pdf", b"%%EOF")):
        first, second = (picture.write(tmp_path / f"{name}.{form}").read_bytes() for name in "ab")
        assert end in first[-20:] and first == second
    with pytest.raises(RacewayError, match="pictures are written as .png, .svg or .pdf"):
        picture.write(tmp_path / "a.jpg")


@pytest.mark.parametrize("shape", [lambda data: data, as_list], ids=["grid", "list"])
def test_a_chosen_value_leaves_the_other_axis_in_rising_order(shape):
    data = shape(made(AXES))
    found = select(data, {"load.axial": 1000})
    assert found.fixed == {"load.axial": 1000.0}
    assert found.axes == {"excitation.speed_rpm": SPEEDS.tolist()}
    # A selection moves numbers and computes none.
    np.testing.assert_array_equal(found.dataset["equivalent_stiffness"], stiffness(SPEEDS, 1000.0))
    whole = select(data, {}).dataset["equivalent_stiffness"]
    assert whole.dims == tuple(AXES)
    np.testing.assert_array_equal(whole.sel({"load.axial": 400.0}), stiffness(SPEEDS, 400.0))


def test_a_list_that_fills_no_grid_stays_a_list():
    data = as_list(made(AXES)).isel(point=slice(0, 20))
    found = select(data, {})
    assert LIST in found.dataset.dims
    assert set(found.axes) == set(AXES)


def test_values_of_the_scene_with_what_the_sweep_changed():
    found = select(made(AXES), {"load.axial": 400.0})
    assert found.value("load.axial") == 400.0
    assert found.value("bearing.preset") == "B7206C"
    assert found.value("kinematics.spin_speed_rpm", 7.0) == 7.0
    with pytest.raises(KeyError):
        found.value("excitation.speed_rpm")


def test_points_without_result_are_counted():
    data = made(AXES)
    data["status"][0, 0], data["status"][1, 0], data["status"][2, 2] = "failed", "failed", "waiting"
    assert select(data, {}).gaps == "2 failed, 1 waiting"
    assert select(data, {"load.axial": 400.0}).gaps == ""


def test_texts_of_at():
    assert parse_at(["load.axial=1e3", "supports.tilt = free"]) == {"load.axial": 1000.0, "supports.tilt": "free"}
    with pytest.raises(SceneError) as told:
        parse_at(["load.axial", "a=1", "a=2"])
    assert "must have the form KEY=VALUE" in str(told.value)
    assert "is chosen twice" in str(told.value)


def test_values_that_are_not_together_in_a_list():
    data = as_list(made({"excitation.speed_rpm": SPEEDS, "load.axial": [400.0, 1000.0]}))
    keep = (data["load.axial"].values == 400.0) | (data["excitation.speed_rpm"].values < 9000.0)
    with pytest.raises(RacewayError, match="no point of the sweep has"):
        select(data.isel(point=np.flatnonzero(keep)), {"load.axial": 1000.0, "excitation.speed_rpm": 30000.0})


SCENE = """
title = "a small sweep"
[bearing]
preset = "B7206C"
[load]
axial = 1000.0
[kinematics]
spin_speed_rpm = 12000.0
"""


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """A static scene over speed and load: ten equilibria."""
    folder = tmp_path_factory.mktemp("store")
    (folder / "scene.toml").write_text(SCENE)
    grids = ("--grid", "kinematics.spin_speed_rpm=2000:30000:5", "--grid", "load.axial=600,1000")
    found = invoke("sweep", folder / "scene.toml", *grids, "--out", folder / "sweep")
    assert found.exit_code == 0, found.stderr
    return folder / "sweep"


def test_plot_chooses_names_and_writes(store):
    found = invoke("sweep", store, "--json")
    assert found.exit_code == 0, found.stderr
    content = json.loads(found.stdout)
    assert (content["value"], content["kind"]) == ("stiffness:y,y", "curves")
    assert (content["x"], content["y"], content["unfinished"]) == ("kinematics.spin_speed_rpm", "load.axial", {})
    (file,) = content["files"]
    assert file == str(store / "stiffness-y-y-curves.png")


def test_plot_of_a_chosen_load(store, tmp_path):
    found = invoke("sweep", store, "--plot", "p0", "--at", "load.axial=600", "--picture", tmp_path / "p0.svg")
    assert found.exit_code == 0, found.stderr
    assert "p0 over kinematics.spin_speed_rpm (curves)" in found.stdout
    assert f"written: {tmp_path / 'p0.svg'}" in found.stdout
    assert "load.axial = 600" in (tmp_path / "p0.svg").read_text()
