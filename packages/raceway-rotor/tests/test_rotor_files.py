"""Coefficients for Nastran and Ansys, and as tables: read by the fields of their formats, compared with the sweep's numbers."""

import json
import re
from types import SimpleNamespace

import numpy as np
import pytest
from raceway_rotor import command
from raceway_rotor.coefficient_file import point_rows
from raceway_rotor.node_bearing import node_bearing

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.rotor_files import COMBI214, DIGITS, apdl, by_direction, constants, entries, read_csv, tables
from checks.validation.stores import SPEEDS, damping, made, scene, stiffness
from raceway import RacewayError, SceneError

SPEED, SPIN = "excitation.speed_rpm", "kinematics.spin_speed_rpm"
RADIANS = np.pi / 30.0
#: A symmetric matrix whose entries all differ.
FULL = np.array(
    [
        [6.1e7, 2.1e6, 3.1e5, 1.1e5, 4.1e5], [2.1e6, 2.1e8, 1.1e7, 3.2e5, 1.2e6], [3.1e5, 1.1e7, 3.1e8, -1.3e6, 2.2e5],
        [1.1e5, 3.2e5, -1.3e6, 2.3e4, 1.5e3], [4.1e5, 1.2e6, 2.2e5, 1.5e3, 3.3e4],
    ]
)  # fmt: skip

PARTS = {"stiffness": 1.0, "damping": 1e-6}


def growing(at):
    return FULL * (1.0 + at[SPEED][..., None, None] / 1e5)


def damped(axes, tables):
    """A sweep of loaded, viscous contacts; C is made as K is, 1e-6 s of it."""
    data = made(axes, tables, stiffness=growing)
    return data.assign(damping=(data["stiffness"].dims, 1e-6 * data["stiffness"].values))


@pytest.fixture(scope="module")
def held():
    return damped({SPEED: SPEEDS}, scene() | {"supports": {"tilt": "locked", "axial": "displacement"}})


def test_nastran_reads_the_diagonal_of_the_tangent(held):
    made_file = rw.export_coefficients(held, kind="nastran", source="tangent", number=40, node=7)
    found = entries(made_file.text)
    (element,) = [fields for name, fields in found if name == "CBUSH"]
    assert element == ["40", "40", "7", "", "", "", "", "0"]  # to ground, in the basic system
    (nominal,) = [fields for name, fields in found if name == "PBUSH"]
    (numbers,) = [fields for name, fields in found if name == "PBUSHT"]
    assert nominal[0] == numbers[0] == "40"
    there = tables(found)
    for letter, of in (("K", FULL), ("B", 1e-6 * FULL)):
        expected = np.zeros((len(SPEEDS), 6))
        expected[:, [0, 1, 2, 4, 5]] = np.diag(of) * (1.0 + SPEEDS[:, None] / 1e5)
        np.testing.assert_allclose([float(one) for one in by_direction(nominal)[letter]], expected[0], rtol=DIGITS)
        for direction, number in enumerate(by_direction(numbers)[letter]):
            if direction == 3:
                assert number == ""
                continue
            hertz, values = there.pop(int(number))
            np.testing.assert_allclose(hertz, (SPEEDS / 60.0), rtol=DIGITS)
            np.testing.assert_allclose(values, expected[:, direction], rtol=DIGITS)
    assert not there  # no table that nothing refers to


def test_nastran_says_what_it_leaves_out(held):
    notes = " ".join(rw.export_coefficients(held, kind="nastran", source="tangent").notes)
    across = FULL[1, 2] / np.sqrt(FULL[1, 1] * FULL[2, 2])
    assert f"left out: kyz, kzy (up to {across:.2g} of the diagonal)" in notes
    size = np.sqrt(np.diag(FULL))
    tilting = np.max(np.abs(FULL[:3, 3:]) / np.outer(size[:3], size[3:]))
    assert f"up to {tilting:.2g} of the geometric mean" in notes
    assert "synchronous response (unbalance) only" in notes and "1e-3" in notes


def test_a_secant_has_no_tilts_and_its_head_is_ascii_of_72_characters():
    made_file = rw.export_coefficients(made({SPEED: SPEEDS}), kind="nastran")
    assert all(len(line) <= 72 and line.isascii() for line in made_file.text.splitlines())
    found = entries(made_file.text)
    assert "CBUSH" not in [name for name, _ in found]  # to complete: a comment
    assert re.search(r"^\$ CBUSH   1       1       GA      GB", made_file.text, re.MULTILINE)
    (numbers,) = [by_direction(fields) for name, fields in found if name == "PBUSHT"]
    there = tables(found)
    for letter, directions, values in (("K", (1, 2), stiffness(SPEEDS, 1000.0)), ("B", (1, 2), damping(SPEEDS))):
        for direction in directions:
            np.testing.assert_allclose(there[int(numbers[letter][direction])][1], values, rtol=DIGITS)
    assert numbers["K"][3:] == numbers["B"][3:] == ["", "", ""]


@pytest.mark.parametrize("axial", ["displacement", "force"])
def test_ansys_reads_the_matrices_across_the_axis(axial):
    data = damped({SPEED: SPEEDS}, scene() | {"supports": {"tilt": "locked", "axial": axial}})
    found, commands = apdl(rw.export_coefficients(data, kind="ansys", source="tangent", number=5).text)
    assert commands[:2] == [["ET", "5", "COMBI214"], ["KEYOPT", "5", "2", "1"]]
    names = constants(commands)
    assert names == [f"{letter}{place}_5" for letter in "KC" for place in COMBI214]
    kept = np.eye(5)[:, 1:3]
    if axial == "force":  # x follows y, z without a force
        kept[0] = -FULL[0, 1:3] / FULL[0, 0]
    for name, place in zip(names, [*COMBI214.values()] * 2, strict=True):
        expected = (kept.T @ FULL @ kept)[place] * (1.0 + SPEEDS / 1e5) * (1.0 if name[0] == "K" else 1e-6)
        np.testing.assert_allclose(found[name][0], SPEEDS * RADIANS, rtol=1e-14)  # 15 digits are written
        np.testing.assert_allclose(found[name][1], expected, rtol=1e-13)


def test_unsymmetric_and_absent_entries_are_told_to_ansys():
    from raceway_rotor.coefficients import Coefficients
    from raceway_rotor.files import ansys_text

    still, speed = np.zeros((3, 5, 5)), np.array([0.0, 10.0, 20.0])
    turning = np.array([[2e8, 1e7], [-1e7, 2e8]]) + np.zeros((3, 1, 1))
    table = Coefficients(speed, None, turning, 0 * turning, speed, "tangent", "made up", (), still, still, "locked")
    found, commands = apdl(ansys_text(table, (), 1))
    assert ["KEYOPT", "1", "3", "1"] in commands and ["RMORE", "0", "0"] in commands
    np.testing.assert_array_equal(found["K12_1"][1], 1e7)
    np.testing.assert_array_equal(found["K21_1"][1], -1e7)
    found, _ = apdl(
        ansys_text(
            Coefficients(speed, None, turning, 1e-5 * turning, speed, "tangent", "made up", (), still, still, "locked"),
            (),
            1,
        )
    )
    assert (found["C12_1"][1][0], found["C21_1"][1][0]) == pytest.approx((100.0, -100.0))


def test_csv_and_json_hold_every_number(held, tmp_path):
    columns = read_csv(rw.export_coefficients(held, source="tangent", kind="csv").text)
    content = json.loads(rw.export_coefficients(held, tmp_path / "b.json", source="tangent").text)
    assert json.loads((tmp_path / "b.json").read_text()) == content
    assert columns.keys() >= {"speed [rad/s]", "kyy [N/m]", "cyy [N s/m]", "K tilt_y z [N m/m]", "C x tilt_z [N s/rad]"}
    np.testing.assert_array_equal(columns["speed [rad/s]"], SPEEDS * RADIANS)
    np.testing.assert_array_equal(content["speed"]["values"], SPEEDS * RADIANS)
    for letter, full in (("K", held["stiffness"].values), ("C", held["damping"].values)):
        np.testing.assert_array_equal(content[letter]["values"], full)  # every bit comes back
        for i, a in enumerate(content["coordinates"]):
            for j, b in enumerate(content["coordinates"]):
                column = f"{letter} {a} {b} [{content[letter]['unit'][i][j]}]"
                np.testing.assert_array_equal(columns[column], full[:, i, j])
    for name, one in content["coefficients"].items():
        np.testing.assert_array_equal(columns[f"{name} [{one['unit']}]"], one["values"])


def test_rows_of_an_unsymmetric_matrix_are_forces_and_columns_displacements():
    """Friction makes K unsymmetric: its row y, column tilt_z is the force along y of a tilt about z."""
    full = FULL + 1e6 * np.triu(np.arange(25.0).reshape(5, 5), 1)
    data = made({SPEED: SPEEDS}, scene() | {"supports": {"tilt": "locked"}})
    both = {name: (data["stiffness"].dims, factor * np.tile(full, (len(SPEEDS), 1, 1))) for name, factor in PARTS.items()}
    data = data.assign(both)
    columns, content = (rw.export_coefficients(data, source="tangent", kind=kind).text for kind in ("csv", "json"))
    columns, content = read_csv(columns), json.loads(content)
    for letter, factor in zip("KC", PARTS.values(), strict=True):
        matrix = np.array(content[letter]["values"])[0]
        for unit, row, column, i, j in (("N", "y", "tilt_z", 1, 4), ("N m", "tilt_z", "y", 4, 1)):
            assert matrix[i, j] == factor * full[i, j]
            per = "rad" if column == "tilt_z" else "m"
            (name,) = [
                one for one in columns if one.startswith(f"{letter} {row} {column} [{unit}") and one.endswith(f"/{per}]")
            ]
            assert columns[name][0] == factor * full[i, j]


def test_a_table_over_speed_and_frequency():
    data = made({SPIN: [0.0, 9000.0], SPEED: SPEEDS})
    columns = read_csv(rw.export_coefficients(data, kind="csv").text)
    np.testing.assert_allclose(columns["speed [rad/s]"], np.repeat([0.0, 9000.0 * RADIANS], len(SPEEDS)))
    np.testing.assert_allclose(columns["frequency [rad/s]"], np.tile(SPEEDS * RADIANS, 2))
    np.testing.assert_array_equal(columns["kyy [N/m]"], np.tile(stiffness(SPEEDS, 1000.0), 2))
    with pytest.raises(RacewayError, match=r"choose one with --at kinematics\.spin_speed_rpm"):
        rw.export_coefficients(data, kind="nastran")
    with pytest.raises(RacewayError, match=r"choose one with --at excitation\.speed_rpm"):
        rw.export_coefficients(data, kind="ansys")
    over = rw.export_coefficients(data, kind="nastran", at={SPIN: 9000.0})
    assert "at one speed of the shaft" in " ".join(over.notes)
    with pytest.raises(RacewayError, match=f"sweep over `{SPIN}` instead"):
        rw.export_coefficients(data, kind="ansys", at={SPIN: 9000.0})


@pytest.mark.parametrize("given, told", [
    ({"kind": "abaqus"}, "must be one of nastran, ansys, csv, json"),
    ({"path": "b.xls"}, "states its kind by the ending: one of .csv, .json"),
    ({"kind": "nastran", "number": 0}, "`number` = 0: must be a whole number below 1e9, at least 1"),
    ({"kind": "ansys", "number": 10**6}, "give an element type of Ansys from 1 to"),
])  # fmt: skip
def test_bad_input_is_refused(held, given, told):
    with pytest.raises(RacewayError, match=re.escape(told)):
        rw.export_coefficients(held, source="tangent", **given)


def test_two_points_are_enough_for_straight_lines():
    assert len(read_csv(rw.export_coefficients(made({SPEED: SPEEDS[:2]}), kind="csv").text)["kyy [N/m]"]) == 2
    with pytest.raises(SceneError, match="has the one value 2000"):
        rw.export_coefficients(made({SPEED: SPEEDS[:1]}), kind="csv")


@pytest.mark.parametrize(
    ("contact", "spin"), [({"damping": 300.0}, 0.0), ({"damping": 300.0}, 20000.0), ({"time_constant": 1e-5}, 20000.0)]
)
def test_the_damping_of_an_equilibrium_is_that_of_its_motion(contact, spin):
    """Of small motions in time, which know nothing of the matrix; a matrix at resting balls is 2 to 14 % off."""
    given = {
        "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "contact": contact, "kinematics": {"spin_speed_rpm": spin},
        "supports": {"tilt": "locked", "axial": "displacement"}, "rotor": {"mass": 2.0}, "integrator": {"kind": "periodic"},
        "excitation": {"kind": "bidirectional", "amplitude": "constant", "force": 1.0, "speed_rpm": 600.0},
    }  # fmt: skip
    result = rw.run(given)
    found = result.equilibrium.damping[1, 1]
    # Small motions: 1 N against 1 kN, 10 Hz against the 10 kHz at which balls lag.
    assert result.identification.equivalent_damping == pytest.approx(found, rel=1e-5)


def test_the_command_writes_all_of_them(tmp_path):
    (tmp_path / "b.toml").write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n[contact]\ndamping = 100.0\n')
    swept = invoke("sweep", tmp_path / "b.toml", "--grid", f"{SPIN}=0:20000:3", "--out", tmp_path / "store")
    assert swept.exit_code == 0, swept.output
    files = [tmp_path / name for name in ("b.bdf", "b.inp", "b.csv")]
    words = [word for pair in zip(("--nastran", "--ansys", "--table"), files, strict=True) for word in pair]
    found = invoke("export", tmp_path / "store", *words, "--number", 3, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert content["files"] == [str(path) for path in files] and content["programs"] == ["Nastran", "Ansys", "CSV"]
    columns = read_csv(files[2].read_text())
    np.testing.assert_array_equal(columns["kyy [N/m]"], content["coefficients"]["kyy"])
    there, _ = apdl(files[1].read_text())
    np.testing.assert_allclose(there["K11_3"][1], columns["kyy [N/m]"], rtol=1e-14)
    nastran = entries(files[0].read_text())
    (numbers,) = [by_direction(fields) for name, fields in nastran if name == "PBUSHT"]
    np.testing.assert_allclose(tables(nastran)[int(numbers["K"][1])][1], columns["kyy [N/m]"], rtol=DIGITS)
    assert columns["C y y [N s/m]"].min() > 0.0
    shown = invoke("export", tmp_path / "store", *words, "--number", 3)
    assert "coefficients for Nastran, Ansys, CSV" in shown.stdout
    for note in content["notes"]:
        assert note[:60].rsplit(" ", 1)[0] in " ".join(shown.stdout.split())
    refused = invoke("export", tmp_path / "store")
    assert refused.exit_code == 2 and "give --ross, --nastran, --ansys or --table" in " ".join(refused.stderr.split())
    refused = invoke("export", tmp_path / "store", "--table", tmp_path / "b.xls")
    assert refused.exit_code == 2 and "states its kind by the ending" in refused.stderr


def test_every_option_of_the_command_reaches_every_file(monkeypatch, tmp_path):
    given, asked = {"at": ("load.axial=1",), "source": "tangent", "damping": 3.0, "node": 7, "tag": "left"}, []
    written = SimpleNamespace(write=lambda path: path)
    for name in ("export_ross", "export_coefficients"):
        monkeypatch.setattr(command, name, lambda *_, **options: asked.append(options) or written)
    command.export(
        "store", *(tmp_path / f"b.{end}" for end in ("toml", "bdf", "inp", "csv")), **given, ross_version="2", number=5
    )
    assert len(asked) == 4 and all(given.items() <= options.items() for options in asked)
    assert asked[0]["ross_version"] == "2"
    assert [(one["kind"], one["number"]) for one in asked[1:]] == [("nastran", 5), ("ansys", 5), ("csv", 5)]


def test_coefficients_are_drawn_and_labelled_in_their_units():
    bearing = rw.export_coefficients(made({SPEED: SPEEDS}), kind="csv")
    for name, column in (("kyy", 1e-6 * stiffness(SPEEDS, 1000.0)), ("cyy", damping(SPEEDS))):
        panel = bearing.plot((name,))
        np.testing.assert_allclose(panel.lines[0].get_xydata(), np.column_stack([SPEEDS, column]))
        assert [panel.get_xlabel(), panel.get_ylabel()] == ["speed [r/min]", "[N/µm]" if name == "kyy" else "[N s/m]"]
    data = bearing.to_xarray()
    assert (data.kyy.units, data.cyy.units, data.speed.units) == ("N/m", "N s/m", "rad/s")


def test_columns_that_are_alike_are_one():
    """As ``raceway export`` shows them, speeds in r/min; what is the same at all points stands below."""
    zero = {name: np.zeros(5) for name in ("kyy", "kyz", "kzy", "kzz", "cyy", "cyz", "czy", "czz", "kxx")}
    rising = 1.23456e8 * (1.0 + 0.1 * np.arange(5))
    values = {**zero, "kyy": rising, "kzz": rising, "kxx": np.full(5, 6e7)}
    rows, constant = point_rows({"speed": 104.719755 * np.arange(5)}, values)
    assert [list(row.values()) for row in rows][:2] == [["0", "123.46"], ["1000", "135.8"]]
    assert list(rows[0]) == ["speed\nr/min", "kyy = kzz\nN/µm"]
    assert constant == ["kxx = 60 N/µm at all points", "0 at all points: kyz, kzy, cyy, cyz, czy, czz"]


@pytest.mark.parametrize("axial", ["force", "displacement"])
def test_a_rotor_s_node_meets_the_rows_following(axial):
    """Coefficients of small motions, and the derivative of the force in time, are one stiffness."""
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "preload_kind": "spring"}
    tables = {"bearing": pair, "load": {"axial": 20.0, "radial": [150.0, 0.0]}}
    node = node_bearing(tables, axial=axial)
    wanted = node.dynamic_stiffness(1e-3, 1200.0).real
    size, h = np.eye(3), 3e-9
    slope = np.array([(node.resistance(1200.0, h * e)[0] - node.resistance(1200.0, -h * e)[0]) / (2.0 * h) for e in size]).T
    np.testing.assert_allclose(slope / wanted.max(), wanted / wanted.max(), atol=1e-6)
    assert wanted[0, 0] == pytest.approx(node.at_rest(1200.0)[1].stiffness[0, 0], rel=1e-9)
