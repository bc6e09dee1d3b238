"""Parts of a sweep: what is chosen, what varies, what has no result."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.errors import RacewayError, SceneError
from raceway.studies.sweep.selection import LIST, keys_of, parse_at, select
from tests.stores import SPEEDS, as_list, made, stiffness

AXES = {"excitation.speed_rpm": SPEEDS, "load.axial": [2000.0, 400.0, 1000.0]}


@pytest.mark.parametrize("shape", [lambda data: data, as_list], ids=["grid", "list"])
def test_a_chosen_value_leaves_the_other_axis_in_rising_order(shape):
    data = shape(made(AXES))
    found = select(data, {"load.axial": 1000})
    assert keys_of(data) == list(AXES)
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


@pytest.mark.parametrize(
    "at, words",
    [
        ({"load.axail": 400.0}, "is not an axis of this sweep (did you mean 'load.axial'?)"),
        ({"load.axial": 500.0}, "is not in the sweep, which has 400, 1000, 2000"),
        ({"load.axial": "many"}, "is not in the sweep"),
    ],
)
def test_what_is_not_there_is_named(at, words):
    with pytest.raises(SceneError) as told:
        select(made(AXES), at)
    assert words in str(told.value)


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
