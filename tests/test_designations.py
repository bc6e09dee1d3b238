"""Makers' designations: what their parts say is used or named as ignored."""

import pytest

import raceway as rw
from raceway import SceneError

#: Designation: name in the catalogue, contact angle [deg], clearance class, class of ISO 492, ceramic balls.
KNOWN = {
    "7206 CD/P4A": ("7206C", 15, "", "P4", ""), "B7206-C-T-P4S": ("B7206C", 15, "", "P4", ""),
    "HCB7014-E-2RSD-T-P4S-UL": ("7014A5", 25, "", "P4", "Si3N4"), "7014 CE/HCP4A": ("7014C", 15, "", "P4", "Si3N4"),
    "71914 ACD/P4A": ("7914A5", 25, "", "P4", ""), "7014CTYNSULP4": ("7014C", 15, "", "P4", ""),
    "7008UCG/GNP42": ("7008UC", 14.522, "", "P4", ""), "7008UADG/GLP42": ("7008UAD", 24.834, "", "P4", ""),
    "6205-2RS": ("6205", 0, "", "", ""), "6201-2Z": ("6201", 0, "", "", ""), "6205-2RS/C3": ("6205", 0, "C3", "", ""),
    "6205DDUC3": ("6205", 0, "C3", "", ""), "6205 c2": ("6205", 0, "C2", "", ""),
    "6805ZZ": ("61805", 0, "", "", ""), "6905": ("61905", 0, "", "", ""), "685": ("618/5", 0, "", "", ""),
    "62/22-2RS": ("62/22", 0, "", "", ""), "W 6204-2RS1/C4": ("6204", 0, "C4", "", ""),
}  # fmt: skip
WITH_FITS = {
    "mounting": {"shaft_interference": 5e-6}, "tolerances": {"load.axial": "±10 %"}, "load": {"axial": 1000.0}
}  # fmt: skip


@pytest.mark.parametrize("text", KNOWN)
def test_a_designation_is_a_bearing_of_the_catalogue(text):
    name, angle, clearance, tolerance, ceramic = KNOWN[text]
    table, plain = rw.catalogue(text)[0].table, rw.catalogue(name)[0].table
    same = ("ball_count", "ball_diameter", "pitch_diameter", "bore", "outer_diameter", "width")
    assert {key: table[key] for key in same} == {key: plain[key] for key in same}
    classed = rw.catalogue(f"{name}/{clearance}")[0].table if clearance else plain
    assert table.get("radial_clearance") == classed.get("radial_clearance")
    assert rw.scene_from_dict(WITH_FITS | {"bearing": {"preset": text}}).source["tolerances"].get("class", "") == tolerance
    assert table["contact_angle_deg"] == angle
    assert table["balls"].get("material", "") == ceramic


def test_a_clearance_class_is_the_middle_of_its_range():
    """ISO 5753-1, over 24 up to 30 mm: C2 1 to 11, CN 5 to 20, C3 13 to 28, C4 23 to 41 um."""
    words = {"": 12.5, "/C2": 6.0, "/CN": 12.5, "/C3": 20.5, "/C4": 32.0}
    for suffix, middle in words.items():
        assert rw.catalogue(f"6206{suffix}")[0].table["radial_clearance"] == pytest.approx(middle * 1e-6), suffix
    scatter = {fact.key: fact.scatter for fact in rw.catalogue("6206/C3")[0].facts}["radial_clearance"]
    assert scatter == pytest.approx(7.5 / 20.5)


@pytest.mark.parametrize("text", ["7014C", "7206 CD/P4A", "6205", "6205-2RS/C3"])
def test_every_part_stands_in_the_result(text):
    geometry = rw.run({"bearing": {"preset": text}, "load": {"axial": 200.0}}).to_dict()["geometry"]
    parts = list(text.replace("-", " ").replace("/", " ").split()[1:])
    assert all(f"{part}: " in geometry["designation"] for part in parts) if parts else "designation" not in geometry
    assert set(geometry["printed"]) >= {"bore", "outer_diameter", "width", "dynamic_rating", "static_rating"}
    assert {"ball_count", "ball_diameter", "conformity_inner"} <= set(geometry["inferred"])
    assert ("radial_clearance" in geometry["inferred"]) is text.startswith("6")


def test_what_is_not_used_is_named_as_ignored():
    scene = {"bearing": {"preset": "6205-2RS-XY77"}, "load": {"axial": 200.0}}
    words = rw.run(scene).to_dict()["geometry"]["designation"]
    assert words == "6205-2RS-XY77: 2RS: seals or shields, ignored; XY77: not known, ignored"


def test_hybrid_bearings_have_ceramic_balls_and_are_stiffer():
    steel, hybrid = (
        rw.run({"bearing": {"preset": name}, "load": {"axial": 1000.0}}) for name in ("B7014-C-T-P4S", "HCB7014-C-T-P4S")
    )
    assert hybrid.model.scene.bearing.balls.young == 310e9
    assert 1.08 < hybrid.stiffness[0, 0] / steel.stiffness[0, 0] < 1.2
    own = {"preset": "HCB7014-C-T-P4S", "balls": {"material": "100Cr6"}}
    assert rw.scene_from_dict({"bearing": own}).bearing.balls.young == 208e9


def test_the_class_acts_in_tolerances_with_fits():
    tables = WITH_FITS | {"bearing": {"preset": "7014 CD/P4A"}}
    assert rw.scene_from_dict(tables).source["tolerances"]["class"] == "P4"
    own = {**tables, "tolerances": {"class": "P5"}}
    assert rw.scene_from_dict(own).source["tolerances"]["class"] == "P5"
    loose = {key: table for key, table in tables.items() if key != "mounting"}
    assert "class" not in rw.scene_from_dict(loose).source["tolerances"]


@pytest.mark.parametrize(("text", "words"), [
    ("30206", "is a tapered roller bearing, which Raceway does not compute"), ("32006-X", "is a tapered roller bearing"),
    ("22210 E", "is a spherical roller bearing"), ("51105", "is a thrust bearing"),
    ("7014", "C is 15, AC or A5 25, A 30 deg: say which); the nearest: 7014C, 7014A, "),
    ("7206 BEP", "40 deg is not in the catalogue); the nearest: "), ("6205XQ", "no such preset; the nearest: 6205, "),
    ("6399", "no such preset; the nearest: "),
])  # fmt: skip
def test_what_is_not_known_is_refused_with_the_nearest(text, words):
    with pytest.raises(SceneError) as caught:
        rw.scene_from_dict({"bearing": {"preset": text}})
    assert caught.value.mistakes[0].path == "bearing.preset" and words in str(caught.value)


def test_the_catalogue_is_asked_by_a_designation():
    (found,) = rw.catalogue("HCB7014-C-T-P4S")
    assert found.title.startswith("HCB7014-C-T-P4S: angular-contact")
