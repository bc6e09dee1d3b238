"""Results of scenes of all kinds beside their records: a change that moves a number says so."""

import os
import shlex

import attrs
import pytest

import raceway as rw
from checks.recorded import differences
from checks.validation.all_kinds import SCENES
from checks.validation.command_line import EXAMPLES

#: Seconds each, and not recorded: the same code runs in smaller scenes.
SLOW = {name for name in SCENES if name == "run_up" or name.startswith(("points, ", "elastic, "))} - {"points, static"}


@pytest.mark.parametrize("name", [name for name in SCENES if name not in SLOW])
def test_a_result_is_as_recorded(name):
    scene, *changes = shlex.split(SCENES[name])
    base = rw.load_scene(EXAMPLES / f"{scene}.toml", changes)
    nudge = float(os.environ.get("RACEWAY_RECORD", 0))
    load = attrs.evolve(
        base.load, axial=base.load.axial * (1.0 + nudge) + nudge * (base.bodies.name != "cylindrical_rollers")
    )
    result = rw.run(attrs.evolve(base, load=load))
    assert not differences(name, result.to_dict())
