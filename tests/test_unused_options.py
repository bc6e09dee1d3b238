"""Options that change nothing are told with the reason, for built-ins and third parties alike."""

import json
from pathlib import Path
from typing import ClassVar

import attrs
import pytest

from checks.validation.command_line import ARTICLE, invoke
from checks.validation.scenes import built_in
from raceway import PluginError, check, option, scene_from_dict
from raceway.testing import b7206c


def idle(excitation):
    """Options of an excitation that are told to have no effect."""
    told = check(b7206c(excitation=excitation, rotor={"mass": 2.0})).warnings
    return {text.partition("`excitation.")[2].partition("`")[0] for text in told if "has no effect: " in text}


@pytest.mark.parametrize(("options", "unused"), [
    ({"unbalance": 1e-4}, set()), ({"unbalance": 1e-4, "load_share": 0.5}, set()),
    ({"unbalance": 1e-4, "force": 300.0}, {"force"}), ({"unbalance": 1e-4, "reference_speed_rpm": 9000.0}, set()),
    ({"amplitude": "constant", "force": 300.0}, set()),
    ({"amplitude": "constant", "unbalance": 1e-4, "reference_speed_rpm": 9000.0, "load_share": 0.5}, set()),
    ({"amplitude": "constant", "force": 300.0, "load_share": 0.5}, {"load_share"}),
    (
        {"amplitude": "constant", "force": 300.0, "unbalance": 1e-4, "reference_speed_rpm": 9000.0},
        {"unbalance", "reference_speed_rpm"},
    ),
])  # fmt: skip
@pytest.mark.parametrize("kind", ["bidirectional", "unidirectional"])
def test_amplitude(kind, options, unused):
    excitation = {"kind": kind, "speed_rpm": 12000.0, **options}
    assert idle(excitation) == unused
    # What is called unused changes nothing.
    without = {name: value for name, value in excitation.items() if name not in unused}
    assert not idle(without)
    one, other = (scene_from_dict(b7206c(excitation=table)).excitation for table in (without, excitation))
    assert one.amplitude_n == other.amplitude_n


@attrs.frozen
class Confused(built_in("contact_law", "hertz")):
    name: ClassVar[str] = "confused"
    answer: object = option(None, help="what unused_options() returns")

    def unused_options(self):
        return self.answer


@pytest.mark.parametrize("answer", [["stiffness"], {"stiffness": "no such option"}, {"answer": 3}])
def test_a_wrong_answer_is_the_authors_mistake(answer):
    scene = scene_from_dict(b7206c())
    confused = attrs.evolve(scene, contact=attrs.evolve(scene.contact, law=Confused(answer=answer)))
    with pytest.raises(PluginError, match="plug-in 'confused': unused_options"):
        check(confused)


@pytest.mark.parametrize(
    ("kind", "changes", "idle"),
    [
        ("newmark", ["integrator.kind=periodic"], 0),  # a key of the file that a change idles is nobody's mistake
        ("newmark", ["identifier.kind=tangent"], 0),
        ("newmark", ["integrator.kind=periodic", "integrator.turns=5"], 1),
        ("periodic", ["load.axial=900"], 1),  # idle in the file already
    ],
)
def test_a_key_without_effect_is_told_where_it_was_meant(kind, changes, idle, tmp_path):
    text = Path(ARTICLE).read_text(encoding="utf-8").replace('kind = "auto"', f'turns = 12\nkind = "{kind}"')
    (tmp_path / "scene.toml").write_text(text)
    words = [word for change in changes for word in ("--set", change)]
    found = invoke("run", tmp_path / "scene.toml", *words, "--out", tmp_path, "--json")
    told = [text for text in json.loads(found.stdout)["warnings"] if "has no effect" in text]
    assert told == idle * ["`integrator.turns` has no effect: integrator 'periodic' needs one turn"]


def test_a_sweep_over_kinds_tells_no_point_of_an_inherited_key(tmp_path):
    words = ("--grid", "integrator.kind=newmark,periodic", "--grid", "load.axial=900,1000", "--out", tmp_path / "store")
    rows = json.loads(invoke("sweep", ARTICLE, *words, "--json").stdout)["rows"]
    assert len(rows) == 4 and not any("has no effect" in text for row in rows for text in row.get("warnings", []))
