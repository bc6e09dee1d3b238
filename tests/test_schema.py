"""The JSON schema accepts what the loader accepts, and refuses what it can know to be wrong."""

import tomllib

import pytest
from jsonschema import Draft202012Validator

from checks.validation.command_line import EXAMPLES
from raceway import load_scene
from raceway.extend import scene_schema
from raceway.testing import Registry, b7206c, default_registry

SCHEMA = scene_schema(default_registry())
CHECK = Draft202012Validator(SCHEMA)


def test_it_is_a_valid_schema():
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.name)
def test_examples_fit(path):
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    assert [error.message for error in CHECK.iter_errors(tables)] == []
    assert [error.message for error in CHECK.iter_errors(load_scene(path).to_dict())] == []


def test_every_installed_plug_in_has_a_branch_with_its_options():
    for table, kind in (("contact", "contact_law"), ("integrator", "integrator"), ("excitation", "excitation")):
        branches = {b["properties"]["kind"]["const"]: b for b in SCHEMA["properties"][table]["oneOf"]}
        assert branches.pop("auto", None) is None or kind == "integrator"
        assert sorted(branches) == default_registry().names(kind)
        for name, branch in branches.items():
            own = {f.name for f in default_registry().find(kind, name).plugin.__attrs_attrs__}
            assert own <= set(branch["properties"])


def test_a_third_party_plug_in_appears(tmp_path, monkeypatch):
    from checks.validation.command_line import install, law

    install(tmp_path, "elsewhere", law("elsewhere_law"))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("RACEWAY_PLUGINS", "elsewhere")
    schema = scene_schema(Registry())
    kinds = [b["properties"]["kind"]["const"] for b in schema["properties"]["contact"]["oneOf"]]
    assert "elsewhere_law" in kinds


WRONG = {
    "unknown table": {"beering": {}}, "unknown key": {"load": {"axail": 3.0}},
    "unknown kind": {"contact": {"kind": "hrtz"}},
    "option of another kind": {"contact": {"kind": "hertz", "stiffness": 1e15}},
    "fraction for an integer": {"bearing": {"ball_count": 12.7}}, "negative": {"rotor": {"mass": -1.0}},
    "string for a number": {"load": {"axial": "much"}}, "conformity at its limit": {"bearing": {"conformity_inner": 0.5}},
    "word": {"supports": {"tilt": "looked"}}, "negative stiffness beside words": {"supports": {"tilt": -3.0}},
    "length of a list": {"load": {"radial": [1.0]}}, "longer list": {"load": {"radial": [1.0, 2.0, 3.0]}}, "preset": {"bearing": {"preset": "B7206G"}},
    "no kind": {"excitation": {"speed_rpm": 3.0}}, "steps below the rule": {"integrator": {"steps_per_turn": 3}},
    "mesher that is not installed": {"mesh": {"kind": "structred"}},
    "mesh without a kind has the structured mesher's keys": {"mesh": {"inner_ring": "ring.inp"}},
    "element size of nothing": {"mesh": {"kind": "structured", "element_size": 0.0}},
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_mistakes_do_not_fit(case):
    assert CHECK.is_valid(b7206c())
    assert not CHECK.is_valid(b7206c(**WRONG[case]))


def test_geometry_is_required_without_a_preset():
    assert not CHECK.is_valid({"bearing": {"ball_count": 3}})
    assert not CHECK.is_valid({"load": {"axial": 3.0}})


def test_units_and_defaults_are_told():
    load = SCHEMA["properties"]["load"]["properties"]["axial"]
    assert load["default"] == 0.0
    assert load["description"].endswith("[N]")
