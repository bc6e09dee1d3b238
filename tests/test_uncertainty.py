"""``uncertainty`` of result.json: one interval of each headline quantity, from parts that are said."""

from itertools import product
from math import hypot, isclose
from types import SimpleNamespace

import attrs
import numpy as np
import pytest
from raceway_app.picture import at_rest, result_picture
from rich.console import Console

import raceway as rw
from checks.validation.command_line import MINIMAL, invoke
from raceway.answers.quantities import KXX, KYY
from raceway.extend import K, radial_note, stated
from raceway.pipeline.uncertainty import elastic_change, interval

STATIC = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
BEARINGS = [
    *({"preset": name} for name in ("B7206C", "7014C", "7914A5", "6205C3", "6310")),
    {"preset": "DGB7-MASTA", "bore": 0.025, "outer_diameter": 0.062, "width": 0.017},
    {"preset": "7206C", "arrangement": "DB", "preload": 290.0},
    {"preset": "7014A", "arrangement": "DB", "preload": 600.0, "preload_kind": "spring"},
]
MOVING = {
    "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "amplitude": "constant", "force": 50.0},
    "rotor": {"mass": 2.0},
}
SOFT = {"kinematics": {"spin_speed_rpm": 6000.0}, "contact": {"kind": "penalty"}, "supports": {"tilt": "free"}}
KINDS = [{}, MOVING, SOFT, MOVING | {"tolerances": {"load.axial": "±5 %"}}, {"bodies": {"kind": "condensed"}}]
#: Elastic rings of every other bearing than B7206C take seconds, and their parts come by the same lines.
#: Each bearing and each kind once and more; all pairs by night.
SCENES = [
    pytest.param(
        {"bearing": bearing, "load": {"axial": 400.0}, **kind},
        marks=[pytest.mark.slow] * ((k + n) % 4 > 0 or "bodies" in kind and k > 0),
    )
    for (k, bearing), (n, kind) in product(enumerate(BEARINGS), enumerate(KINDS))
]


def differences(scene):
    """What the table says otherwise than its sources, and what screen or application say otherwise than the table."""
    result, wrong = rw.run(scene), []
    content, other = result.to_dict(), rw.run({**scene, "contact": {}}) if "contact" in scene else result
    error, geometry, spread = content["error"], content["geometry"] or {}, content["error"]["model"] or {}
    change = elastic_change(result.model, result.equilibrium)
    band = (content["tolerances"] or {"quantities": {}})["quantities"]
    for quantity in (K, KYY):
        if (entry := content["uncertainty"][quantity.name]) is None:
            continue
        size, left = error["mesh"] or 0.0, error["contact"] or 0.0 if "bodies" in scene else 0.0
        if quantity is K:
            size = content["identification"]["equivalent_stiffness_error"] / abs(entry["value"])
        hertz, elastic = (
            other.stiffness[1, 1] / result.stiffness[1, 1] - 1.0, 0.0 if isinstance(change, str) else change["kyy"],
        )  # fmt: skip
        hypotheses = spread.get(quantity.name) or spread.get("kyy") or (0.0, 0.0)
        for end, sign in enumerate((-1.0, 1.0)):
            signed = sum(max(sign * part, 0.0) for part in (hypotheses[end], hertz, elastic)) + left
            inferred = [part["radial"][end] for part in geometry.get("data", [])]
            tolerated = band.get(quantity.symbol, {"low": entry["value"], "high": entry["value"]})[("low", "high")[end]]
            expected = sign * hypot(signed, *inferred, tolerated / entry["value"] - 1.0, size)
            # Hypotheses that a bound says to change less than 0.1 % are not solved.
            wrong += (
                []
                if isclose(expected, entry["relative"][end], rel_tol=1e-6, abs_tol=1e-3)
                else [(quantity.symbol, expected)]
            )
    with (console := Console(width=2000)).capture() as captured:
        console.print(result.screen())
    screen, rows = " ".join(captured.get().split()), result_picture(result, at_rest(result))["rows"]
    for label, value, words in (stated(one, content) for one in ((K,) if K.of(content) is not None else (KXX, KYY))):
        within, _, parts = words.partition(": ")
        # A full screen cuts what makes the interval at the end of a line.
        beginning = screen.partition(f"{label} {value} {within} ")[2].partition(" …")[0]
        shown = beginning and (beginning.startswith(parts) or parts.startswith(beginning)) and [label, value, within] in rows
        wrong += [] if shown else [(label, value, words)]
    return wrong


@pytest.fixture(scope="module")
def moving():
    return rw.run(MINIMAL)


@pytest.mark.parametrize("scene", SCENES)
def test_an_interval_is_what_its_parts_say(scene):
    assert differences(scene) == []


def test_loads_and_lives_go_to_the_ends_of_inferred_numbers():
    """6205: the clearance within its class, balls and grooves within their scatter, each in a run of its own."""
    scene = {"bearing": {"preset": "6205C3"}, "load": {"radial": [500.0, 0.0]}}
    result, changes = rw.run(scene), list[float]()
    for key, fact in result.geometry["inferred"].items():
        if fact["scatter"] and key != "ball_count":
            more = rw.run({**scene, "bearing": {"preset": "6205C3", key: fact["value"] * (1.0 + fact["scatter"])}})
            changes.append(max(more.extremes["p0"] / result.extremes["p0"] - 1.0, 0.0))
    entry, largest = result.uncertainty["p0"], max(changes)
    assert largest <= entry["relative"][1] <= hypot(*changes) + 0.05
    life = result.uncertainty["l10r_million_revolutions"]["relative"]
    assert life[0] < -0.05 and life[1] > 0.05 and life[0] > -1.0


def test_a_quantity_without_an_uncertainty_says_why(moving):
    table = rw.run(STATIC).to_dict()["uncertainty"]
    absent = {"equivalent_stiffness": "static", "kyy_tilts_follow": "locked", "running_preload": "no preload"}
    assert set(table["why"]) == set(absent) and all(table[name] is None for name in absent)
    assert all(word in table["why"][name] for name, word in absent.items())
    rollers = rw.run({"bearing": {"preset": "NU206"}, "load": {"radial": [2000.0, 0.0]}}).uncertainty
    assert "roller" in rollers["why"]["l10r_million_revolutions"] and rollers["kxx"] is None
    pair = rw.run({"bearing": {"preset": 6205, "arrangement": "DB", "preload": 300.0}}).uncertainty  # a number for a name
    assert pair["running_preload"] is None and "data" in pair["why"]["running_preload"]
    total = attrs.evolve(moving.errors.total, size=2.0)
    spoilt = attrs.evolve(moving, errors=attrs.evolve(moving.errors, total=total))
    assert "not resolved" in spoilt.uncertainty["why"]["equivalent_stiffness"]
    endless = attrs.evolve(moving, equilibrium=attrs.evolve(moving.equilibrium, stiffness=np.full((5, 5), np.inf)))
    assert endless.uncertainty["kyy"] is None and "inf" in endless.uncertainty["why"]["kyy"]


def test_the_first_screen_has_28_lines_and_the_interval_in_five(moving):
    lines = invoke("run", MINIMAL).stdout.splitlines()
    place = next(k for k, line in enumerate(lines) if "equivalent stiffness K" in line)
    assert place <= 3 and "%" in lines[place] and len(lines) <= 28
    assert " ".join(lines[place + 1].split()) == interval(moving.uncertainty["equivalent_stiffness"]).partition(": ")[2]
    assert not any("uncertain by" in line or "model error" in line for line in lines)


def test_sweeps_have_the_ends_where_they_are_asked_for():
    found = rw.sweep(STATIC, {"load.axial": [400.0, 1000.0]}, quantities=["kyy_low", "kyy_high"])
    entry = rw.run(STATIC).uncertainty["kyy"]
    assert [found[f"kyy_{end}"].values[1] for end in ("low", "high")] == [entry["low"], entry["high"]]
    assert found.status.values.tolist() == ["run", "run"] and found.kyy_low.attrs["units"] == "N/m"
    with pytest.raises(rw.SceneError, match="must be one of 'K_low'"):
        rw.sweep(STATIC, {"load.axial": [400.0]}, quantities=["speed"])


def test_files_for_other_programs_say_it(monkeypatch):
    """The store knows what the scene leaves to its preset.  Ten seconds is what a note may take."""
    swept = rw.sweep(
        {**STATIC, "kinematics": {"spin_speed_rpm": 0.0}}, {"kinematics.spin_speed_rpm": [0.0, 500.0, 1000.0, 1500.0]}
    )
    for notes in (
        rw.export_coefficients(swept, kind="nastran").notes,
        rw.export_fmu(STATIC, ranges=["load.axial=900:1100"], outputs=["kyy"]).notes,
    ):
        assert any("kyy of the scene itself" in note and "inferred geometry" in note for note in notes), notes
    for seconds, count in ((9.0, 1), (11.0, 0)):
        plan = SimpleNamespace(predicted_wall_s=seconds)
        monkeypatch.setattr("raceway.planning.plan.make_plan", lambda scene, plan=plan: plan)
        assert len(radial_note(STATIC)) == count
