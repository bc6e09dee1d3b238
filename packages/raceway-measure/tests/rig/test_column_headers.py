"""Records as other programs write them: every header gives the numbers of our own, or one message that mends it."""

import numpy as np
import pytest
from raceway_measure.fit.column_headers import columns_of
from raceway_measure.fit.signals import recording_of, signals_of

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from raceway import SceneError

SCENE = EXAMPLES / "test_rig.toml"
COUNT, TURN = 400, 50
TIME = 1e-4 * np.arange(COUNT)
ANGLE = 2.0 * np.pi * np.arange(COUNT) / TURN
#: Two decimals: the same decimal text whatever the sign is, so that the same bits come back.
Y, Z, KEY = np.round(15.0 * np.cos(ANGLE), 2), np.round(15.0 * np.sin(ANGLE), 2), 5.0 * (np.arange(COUNT) % TURN < 5)
OURS = "time_s,y_um,z_um,key"


def text(head, sign=",", point=".", quoted=False):
    """The record under another head."""
    lines = [head]
    for row in zip(TIME, Y, Z, KEY, strict=True):
        words = [f"{value:.{digits}f}".replace(".", point) for value, digits in zip(row, (4, 10, 10, 1), strict=True)]
        lines.append(sign.join(f'"{word}"' if quoted else word for word in words))
    return "\n".join(lines) + "\n"


#: Headers of the table "CSV heads accepted", and what else programs write.
FILES = {
    "Time (s),X [um],Y [um]": text("Time (s),X [um],Y [um],Keyphasor (V)"),
    "micro sign": text("Time (s),X [µm],Y [μm],Key [V]"),
    "semicolons and decimal commas": text("Time (s);X [um];Y [um];Trigger", ";", ","),
    "quotes": text('"Time (s)","X [um]","Y [um]","Key (V)"', quoted=True),
    "quotes, semicolons and decimal commas": text('"Time (s)";"X [um]";"Y [um]";"Key (V)"', ";", ",", quoted=True),
    "gaps by words": text("t / s,Gap Y / um,Gap Z / um,Key"),
    "blanks": text(" time_s , Displacement X (um) , Displacement Y (um) , mark "), "other columns between": text(OURS),
}  # fmt: skip


@pytest.mark.parametrize("case", FILES)
def test_every_head_gives_the_record_to_the_last_bit(case, tmp_path):
    (tmp_path / "ours.csv").write_text(text(OURS))
    (tmp_path / "theirs.csv").write_text(FILES[case])
    ours, theirs = (recording_of(signals_of(tmp_path / f"{name}.csv")) for name in ("ours", "theirs"))
    for name in ("time", "y", "z", "key"):
        np.testing.assert_array_equal(getattr(theirs, name), getattr(ours, name))
    # Not by chance of the reader: these are the numbers that were written.
    np.testing.assert_array_equal(ours.y, np.array([float(f"{v:.10f}") for v in Y]) * 1e-6)


def test_a_map_names_columns_on_the_command_line_and_in_python(tmp_path):
    path, given = tmp_path / "record.csv", {"Ch 1": "y_um", "Ch 2": "z_um", "Ch 3": "key"}
    path.write_text(text("Time (s),Ch 1,Ch 2,Ch 3"))
    np.testing.assert_allclose(signals_of(path, given).columns["y"], 1e-6 * Y, rtol=1e-12)
    options = [word for head, name in given.items() for word in ("--map", f"{head}={name}")]
    found = invoke("identify", path, "--scene", SCENE, *options, "--out", tmp_path / "out", "--json")
    assert found.exit_code == 0, found.output
    own = rw.identify(path, SCENE, columns=given)
    assert f'"equivalent_stiffness": {own.equivalent_stiffness!r}' in found.stdout
    assert columns_of(["Time (s)", "X [um]", "Y [um]"], {"X [um]": "y_um"})["y"] == (1, 1e-6)


#: Heads, and what the one message says: what was found, and the map that mends it.
MESSAGES = {
    "Time (s),Ch 1,Ch 2,Ch 3": ["3 columns are not known", "'Time (s)' as time_s", '--map "Ch 1=y_um" --map "Ch 2=z_um" --map "Ch 3=key"'],
    "Time,X,Y,key": ["'X' has no unit", '--map "Time=time_s" --map "X=y_um" --map "Y=z_um"'],
    "time_s,x_um,y_um,z_um": ["'x_um' may be along the shaft or across it", '--map "x_um=ignore"'],
    "time_s,y_um,z_um,Oil [C],key": ["unknown column 'Oil [C]'", '--map "Oil [C]=ignore"', 'columns={"Oil [C]": "ignore"}'],
    "time_s,X [V],Y [V],key": ["is a voltage: multiply it by the sensor's sensitivity first"],
    "time_s,y_um,y_mm,key": ["y is duplicated", "'y_mm' as y_mm", '--map "y_mm=ignore"'],
}  # fmt: skip


@pytest.mark.parametrize("head", MESSAGES)
def test_one_message_says_what_was_found_and_what_mends_it(head, tmp_path):
    path = tmp_path / "record.csv"
    path.write_text(text(head))
    found = invoke("identify", path, "--scene", SCENE, "--out", tmp_path / "out")
    assert found.exit_code == 2 and found.stderr.count("error:") == 1
    for words in (str(path), *MESSAGES[head]):
        assert words in found.stderr


@pytest.mark.parametrize("columns, words", [
    ({"Z": "y_um"}, "no column 'z' for --map"),
    ({"X [um]": "y_umm"}, "unknown name (did you mean 'y_um'?)"),
    ({"X [um]": "y_mm"}, "'X [um]' cannot be y_mm: its header has another unit, and y_um is meant"),
])  # fmt: skip
def test_a_map_that_maps_nothing_is_refused(columns, words):
    with pytest.raises(ValueError) as told:
        columns_of(["Time (s)", "X [um]", "Y [um]"], columns)
    assert words in str(told.value)


def test_a_map_without_a_name_is_refused(tmp_path):
    found = invoke("identify", "a.csv", "--scene", SCENE, "--map", "y_um", "--out", tmp_path)
    assert found.exit_code == 2 and '"X [µm]=y_um"' in found.stderr


def test_a_shaker_s_record_is_read_and_told_what_is_missing():
    record = signals_of({"Time (s)": TIME, "Force [N]": 20.0 * np.cos(ANGLE), "Displacement [mm]": 1e-3 * Y})
    np.testing.assert_allclose(record.columns["y"], 1e-6 * Y, atol=1e-12)
    with pytest.raises(
        SceneError, match=r"400 samples over 0.0399 s of force \(\+- 20 N\), y \(\+- 15 µm\).*raceway fit FILE.csv"
    ):
        recording_of(record)


def forms():
    """The record in memory, in each form that is taken."""
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    plain = {"time_s": TIME, "y_um": Y, "z_um": Z, "key": KEY}
    units = {"y": Y, "z": Z}
    labelled = xarray.Dataset(
        {**{name: ("time", values, {"units": "um"}) for name, values in units.items()}, "key": ("time", KEY)},
        {"time": ("time", TIME, {"units": "s"})},
    )
    return {"mapping": plain, "data frame": pandas.DataFrame(plain), "data set": labelled}


@pytest.mark.parametrize("form", ["mapping", "data frame", "data set"])
def test_a_record_in_memory_gives_the_same_bits(form, tmp_path):
    found = signals_of(forms()[form])
    for name, values in {"time": TIME, "y": 1e-6 * Y, "z": 1e-6 * Z, "key": KEY}.items():
        np.testing.assert_array_equal(found.columns[name], values)


@pytest.mark.parametrize("given, words", [
    ({"time_s": TIME, "y_um": Y[:-1]}, "differ in length: time_s 400, y_um 399"),
    ({"time_s": TIME, "y_um": np.where(ANGLE > 3.0, np.nan, Y)}, "column 'y_um': sample 24 is missing"),
    ({"time_s": TIME, "y_um": np.column_stack([Y, Z])}, "has the shape (400, 2)"),
    ({"time_s": TIME, "Ch 1": Y}, 'columns={"Ch 1": "y_um"}'),
    ({"time_s": TIME[::-1], "y_um": Y}, "sample 1: time must grow"),
    (3.0, "must be a CSV file's path, a mapping of arrays"),
])  # fmt: skip
def test_arrays_that_are_no_record_are_refused(given, words):
    with pytest.raises(SceneError) as told:
        signals_of(given)
    assert words in str(told.value)


def test_the_answer_shows_itself_and_is_read_again():
    signals = {"time_s": TIME, "y_um": 15.0 * np.cos(ANGLE), "z_um": 15.0 * np.sin(ANGLE), "speed_rpm": 12000.0 + 0.0 * TIME}
    found = rw.identify(signals, SCENE)
    assert found.speed_rpm == pytest.approx(12000.0, rel=1e-9)
    assert len(repr(found).splitlines()) <= 15 and "<table" in found._repr_html_()
    content = found.to_dict()["identification"]
    assert found.equivalent_stiffness == content["equivalent_stiffness"] and found.equivalent_damping is None
    again = rw.identify(found.to_xarray(), SCENE)
    # The same samples and the same speed; their angles begin at the record's first sample again.
    assert again.equivalent_stiffness == pytest.approx(found.equivalent_stiffness, rel=1e-9)
    assert found.plot().get_xlabel() == "y [µm]" and "order" in found.plot("spectrum").get_xlabel()
    with pytest.raises(SceneError, match="must be one of orbits, spectrum"):
        found.plot("waterfall")
