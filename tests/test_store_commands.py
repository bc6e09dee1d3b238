"""``raceway plot`` and ``raceway export`` on the store of a real sweep."""

from __future__ import annotations

import json
import tomllib
from importlib.metadata import PackageNotFoundError

import numpy as np
import pytest

from raceway.studies.ross import file as ross_file
from validation.command_line import invoke

SCENE = """
title = "a small sweep"
[bearing]
preset = "B7206C"
[load]
axial = 1000.0
[kinematics]
spin_speed_rpm = 12000.0
"""
LOADS = (600.0, 1000.0)


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
    found = invoke("plot", store, "--json")
    assert found.exit_code == 0, found.stderr
    content = json.loads(found.stdout)
    assert (content["value"], content["kind"]) == ("stiffness:y,y", "curves")
    assert (content["x"], content["y"], content["unfinished"]) == ("kinematics.spin_speed_rpm", "load.axial", {})
    (file,) = content["files"]
    assert file == str(store / "stiffness-y-y-curves.png")


def test_plot_of_a_chosen_load(store, tmp_path):
    found = invoke("plot", store, "--value", "p0", "--at", "load.axial=600", "--out", tmp_path / "p0.svg")
    assert found.exit_code == 0, found.stderr
    assert "p0 over kinematics.spin_speed_rpm (curves)" in found.stdout
    assert f"written: {tmp_path / 'p0.svg'}" in found.stdout
    assert "load.axial = 600" in (tmp_path / "p0.svg").read_text()


def test_export_writes_the_numbers_of_the_store(store, tmp_path):
    words = ("export", store, "--ross", tmp_path / "b.toml", "--at", "load.axial=1000", "--ross-version", 3, "--json")
    found = invoke(*words)
    assert found.exit_code == 0, found.stderr
    content = json.loads(found.stdout)
    section = tomllib.loads((tmp_path / "b.toml").read_text())["BearingElement_B7206C"]
    import xarray

    data = xarray.load_dataset(store / "results.nc", engine="h5netcdf").sel({"load.axial": 1000.0})
    tangent = data["stiffness"].sel(dof=["x", "y", "z"], dof2=["x", "y", "z"]).values
    radial = tangent[:, 1:, 1:] - tangent[:, 1:, :1] * tangent[:, :1, 1:] / tangent[:, :1, :1]
    # The same few operations on the same numbers; the cross terms are rounding of the 1e8 beside them.
    np.testing.assert_allclose(section["kxx"], radial[:, 0, 0], rtol=1e-14)
    np.testing.assert_allclose(section["kyy"], radial[:, 1, 1], rtol=1e-14)
    np.testing.assert_allclose(section["kxy"], radial[:, 0, 1], atol=1e-6)
    np.testing.assert_array_equal(section["kzz"], tangent[:, 0, 0])
    np.testing.assert_allclose(section["speed"], np.linspace(2000.0, 30000.0, 5) * np.pi / 30.0, rtol=1e-15)
    assert content["coefficients"]["kyy"] == section["kxx"]
    assert not np.any(section["cxx"])


def test_export_says_what_is_lost_and_for_which_ross(store, tmp_path, monkeypatch):
    def absent(_name):
        raise PackageNotFoundError

    monkeypatch.setattr(ross_file, "version", absent)
    found = invoke("export", store, "--ross", tmp_path / "b.json", "--at", "load.axial=600")
    assert found.exit_code == 0, found.stderr
    assert "ROSS is not installed here; the file is for ROSS 3" in found.stderr
    assert "moments on the ring" in found.stdout
    assert "kyy = kzz" in found.stdout and "r/min" in found.stdout and "rad/s" not in found.stdout.partition("note")[0]
    monkeypatch.setattr(ross_file, "version", lambda _name: "2.3.0")
    found = invoke("export", store, "--ross", tmp_path / "b.json", "--at", "load.axial=600")
    assert "for ROSS 2" in found.stdout
    assert "frequency" in json.loads((tmp_path / "b.json").read_text())["BearingElement_B7206C"]
