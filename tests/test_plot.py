"""Pictures of sweeps: what is chosen by default, what is refused, and what the figures hold."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.errors import RacewayError, SceneError
from raceway.studies.sweep.picture import draw
from raceway.studies.sweep.plotting import layout
from raceway.studies.sweep.selection import select
from tests.stores import SPEEDS, as_list, made, stiffness

SPEED, LOAD = "excitation.speed_rpm", "load.axial"
MANY = np.linspace(200.0, 2000.0, 9)


def chosen(axes, at=None, **wanted):
    return layout(select(made(axes), at or {}), **wanted)


def drawn(picture):
    return draw(picture.data, picture.kind, picture.x, picture.y, picture.panels, picture.title, picture.remark)


@pytest.mark.parametrize(
    "axes, kind, x, y, panels",
    [
        ({SPEED: SPEEDS}, "curves", SPEED, None, None),
        ({LOAD: [400.0, 1000.0], SPEED: SPEEDS}, "curves", SPEED, LOAD, None),
        ({LOAD: MANY, SPEED: SPEEDS}, "map", SPEED, LOAD, None),
        ({LOAD: MANY, "supports.tilt": ["free", "locked"]}, "curves", LOAD, "supports.tilt", None),
        ({LOAD: MANY[:3], "supports.tilt": ["free", "locked"], SPEED: SPEEDS}, "curves", SPEED, LOAD, "supports.tilt"),
        ({"supports.tilt": ["free", "locked"]}, "curves", "supports.tilt", None, None),
    ],
)
def test_defaults_follow_the_axes(axes, kind, x, y, panels):
    found = chosen(axes)
    assert (found.kind, found.x, found.y, found.panels) == (kind, x, y, panels)
    assert found.name == "equivalent_stiffness"
    drawn(found)


def test_curves_hold_the_numbers_in_readable_units():
    picture = chosen({SPEED: SPEEDS, LOAD: [400.0, 1000.0]})
    axes = drawn(picture).axes[0]
    assert [line.get_label() for line in axes.lines] == ["400", "1000"]
    for line, load in zip(axes.lines, (400.0, 1000.0), strict=True):
        np.testing.assert_array_equal(line.get_xdata(), SPEEDS)
        np.testing.assert_allclose(line.get_ydata(), stiffness(SPEEDS, load) * 1e-6, rtol=1e-15)  # one product
    assert axes.get_xlabel() == "excitation.speed_rpm [r/min]"
    assert axes.get_ylabel() == "equivalent stiffness [N/µm]"


@pytest.mark.parametrize("kind", ["map", "surface"])
def test_maps_and_surfaces_have_both_axes_with_units(kind):
    axes = drawn(chosen({SPEED: SPEEDS, LOAD: MANY}, kind=kind)).axes
    assert (axes[0].get_xlabel(), axes[0].get_ylabel()) == ("excitation.speed_rpm [r/min]", "load.axial [N]")
    value = axes[0].get_zlabel() if kind == "surface" else axes[1].get_ylabel()
    assert value == "equivalent stiffness [N/µm]"


def test_chosen_values_and_points_without_result_stand_in_the_picture():
    data = made({SPEED: SPEEDS, LOAD: [400.0, 1000.0]})
    data["equivalent_stiffness"][2, 0] = np.nan
    data["status"][2, 0] = "failed"
    picture = layout(select(data, {LOAD: 400.0}))
    assert picture.remark == "load.axial = 400; without result: 1 failed"
    figure = drawn(picture)
    assert "without result: 1 failed" in figure.get_suptitle()
    assert np.isnan(figure.axes[0].lines[0].get_ydata()[2])


def test_a_list_is_drawn_as_points():
    data = as_list(made({SPEED: SPEEDS, LOAD: MANY})).isel(point=slice(0, 50))
    for kind in ("curves", "map"):
        drawn(layout(select(data, {}), kind=kind))
    with pytest.raises(RacewayError, match="fill no grid, and a surface needs one"):
        layout(select(data, {}), kind="surface")


def test_entries_of_arrays_have_their_own_unit():
    picture = chosen({SPEED: SPEEDS}, value="stiffness:y,y")
    assert picture.data.attrs["units"] == "N/m"
    assert chosen({SPEED: SPEEDS}, value="stiffness:tilt_y,tilt_y").data.attrs["units"] == "N m/rad"
    np.testing.assert_array_equal(picture.data, np.full(len(SPEEDS), 2e8))


@pytest.mark.parametrize(
    "axes, wanted, words",
    [
        ({SPEED: SPEEDS}, {"value": "p1"}, "is not a quantity of this sweep"),
        ({SPEED: SPEEDS}, {"value": "stiffness"}, "takes 2 labels after a colon, for instance stiffness:y,y; 0 given"),
        ({SPEED: SPEEDS}, {"value": "stiffness:y,v"}, "has no 'v'"),
        ({SPEED: SPEEDS}, {"value": "p0:y"}, "takes 0 labels"),
        ({SPEED: SPEEDS, LOAD: MANY}, {"x": "load.axail"}, "is not an axis of this sweep (did you mean 'load.axial'?)"),
        ({SPEED: SPEEDS, LOAD: [400.0]}, {"x": LOAD}, "has the one value 400 here"),
        ({SPEED: SPEEDS, LOAD: MANY}, {"x": LOAD, "y": LOAD}, "is the axis of --x already"),
        ({SPEED: SPEEDS}, {"kind": "map"}, "takes two axes with numbers, and only excitation.speed_rpm varies"),
        (
            {SPEED: SPEEDS, "supports.tilt": ["free", "locked"]},
            {"kind": "map", "y": "supports.tilt"},
            "has words for values",
        ),
        (
            {SPEED: SPEEDS, LOAD: MANY, "contact.damping": MANY[:7]},
            {"kind": "curves"},
            "have no place for it: choose one with --at",
        ),
        ({SPEED: SPEEDS[:1]}, {}, "nothing varies in this part of the sweep"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_the_way_out(axes, wanted, words):
    with pytest.raises(RacewayError) as told:
        chosen(axes, **wanted)
    assert words in str(told.value)
    assert issubclass(SceneError, RacewayError)


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
    first, second = (picture.write(tmp_path / name).read_bytes() for name in ("a.svg", "b.svg"))
    assert b"</svg>" in first[-20:]
    assert first == second
    with pytest.raises(RacewayError, match="pictures are written as .png or .svg"):
        picture.write(tmp_path / "a.pdf")
