"""Instruments' own files: K lies within its interval, without a script; what cannot be read is refused with line, rule and remedy."""

import json

import numpy as np
import pytest
from instrument_files import DAMPING, FORMS, MASS, STIFFNESS, WORDS, write
from raceway_measure.fit.column_headers import columns_of
from raceway_measure.fit.signals import signals_of

import raceway as rw
from checks.validation.command_line import invoke
from raceway import SceneError
from raceway.extend import read_numbers


@pytest.mark.parametrize("instrument", [*FORMS, "tdms"])
def test_k_of_an_instrument_s_file_lies_within_its_interval_or_a_message_mends_it(instrument, tmp_path):
    if instrument == "tdms":
        pytest.importorskip("nptdms")
    path, columns = write(instrument, tmp_path)
    options = [word for header, name in columns.items() for word in ("--map", f"{header}={name}")]
    answer = invoke("fit", path, "--free", "K,C,mass", *options, "--out", tmp_path / "out", "--no-pictures")
    if not columns:
        assert answer.exit_code == 2 and all(words in answer.stderr for words in (str(path), *WORDS[instrument]))
        return
    assert answer.exit_code == 0, answer.output
    told = json.loads((tmp_path / "out" / "fit.json").read_text())
    free = {row["key"]: row for row in told["free"]}
    for name, truth in {"K": STIFFNESS, "C": DAMPING, "mass": MASS}.items():
        half = free[name]["error"]
        assert abs(free[name]["value"] - truth) < half < 0.02 * truth
    texts = {"tensile": "Bemerkung", "graphtec": "Date&Time"}.get(instrument, "")
    assert (f"the text of '{texts}' is left out" in told["warnings"]) == bool(texts)


ROWS = "0,0.5,0.25\n" * 3
#: A file, the meaning of its columns, and what the one message says.
REFUSED = {
    "a voltage without sensitivity": ("x-axis,1,2\nsecond,Volt,Volt\n" + ROWS, {"1": "force_n", "2": "x_um"}, ["line 1", "is a voltage", "CH1=force_n*100"]),
    "channels without a meaning": ("Model,MSO54\nVertical Units,V,V\nTIME,CH1,CH2\n" + ROWS, {}, ["line 3", "missing: force, displacement", "'CH1 (V)'", '--map "CH1 (V)=force_n*FACTOR"']),
    "no line of column headers": ("Model,MSO54\nVertical Units,V,V\n" + ROWS, {}, ["line 3", "missing: time", "'column 2 (V)'", '--map "column 1=time_s"']),
    "no interval": ("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,0\n" + ROWS, {}, ["line 1", "missing: time", "'X (Sequence)'"]),
    "times of each channel": ("LabVIEW Measurement\nX_Value\tA\tX_Value\tB\n" + "0\t1\t0\t1\n" * 3, {}, ["line 2", "save one column of times"]),
    "one quantity": ("Zeit [s];Kraft [N]\n" + "".join(f"{0.1 * k:.1f};{k % 3}\n" for k in range(40)), {"Kraft [N]": "force_n"}, ["missing is displacement"]),
    "no sensor gives it": ("time_s,force_n,x_um\n" + ROWS + "1,-1e308,0\n", {}, ["line 5", "a sample is missing (1,-1e308,0)"]),
    "a factor beyond all": ("time_s,CH1,x_um\n" + "".join(f"{k},{k},1\n" for k in range(40)), {"CH1": "force_n*1e300"}, ["line 3: force is no number that a sensor gives"]),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_refused_with_line_rule_and_remedy(case, tmp_path):
    text, columns, words = REFUSED[case]
    path = tmp_path / "file.csv"
    path.write_text(text)
    with pytest.raises(SceneError) as refusal:
        rw.fit(path, None, "K", columns=columns)
    for word in (str(path), *words):
        assert word in str(refusal.value)


#: Files whose three rows are 0, 0.5 and 1 ms, in variants that the generator does not write.
VARIANTS = {
    "LabVIEW without times": (
        "LabVIEW Measurement\t\nX_Columns\tNo\n***End_of_Header***\t\nX0\t0\t0\nDelta_X\t0.0005\t0.0005\n***End_of_Header***\t\n"
        "X_Value\tA\tB\tComment\n" + "\t1.5\t2.5\n" * 3
    ),
    "Tektronix with signs of comments": "#Model,MDO3014\n#Horizontal Units,s\n#Vertical Units,V,V\n#,,\n#TIME,A,B\n0,1.5,2.5\n5e-4,1.5,2.5\n1e-3,1.5,2.5\n",
    "a rate in MHz": "Sampling rate 0.002 MHz\n\nA;B\n" + "1,5;2,5\n" * 3,
    "Rigol DS1000E": "Time,A,B\nSecond,Volt,Volt\n0,1.5,2.5,\n5e-4,1.5,2.5,\n1e-3,1.5,2.5,\n",
    "PicoScope with tabs": "Time\tA\tB\n(ms)\t(V)\t(V)\n\n0\t1,5\t2,5\n0,5\t1,5\t2,5\n1\t1,5\t2,5\n",
    "text in the first column": "# a\n\nnote;Time (ms);A;B\nok;0;1,5;2,5\n5 mm, ok;0,5;1,5;2,5\n;1;1,5;2,5\n",
    "Windows' letters": "Time (s);A [µm];B\n0;1,5;2,5\n0,0005;1,5;2,5\n0,001;1,5;2,5\n",
    "blanks and a mark of UTF-16": "\ufeffTime (s)   A (V)  B\n 0  1.5 2.5\n5e-4 1.5   2.5\n1e-3 1.5 2.5\n",
}  # fmt: skip


@pytest.mark.parametrize("case", VARIANTS)
def test_variants_of_the_formats_give_the_same_columns(case, tmp_path):
    path = tmp_path / "file.csv"
    path.write_text(VARIANTS[case], encoding={"W": "cp1252", "b": "utf-16-le"}.get(case[0]))
    table = read_numbers(path, lambda header: None)
    scale = 1e3 if "(ms)" in table.header[0] else 1.0
    np.testing.assert_array_equal(table.values, [[scale * time, 1.5, 2.5] for time in (0.0, 5e-4, 1e-3)])
    assert [header[:1].lower() for header in table.header] == ["t", "a", "b"]


def test_channels_of_two_clocks_and_a_file_that_is_cut_off_are_refused_by_name(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "two.tdms"
    channels = [
        nptdms.ChannelObject("g", name, [0.0, 1.0], {"wf_increment": step}) for name, step in (("ai0", 1e-3), ("ai1", 2e-3))
    ]
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(channels)
    with pytest.raises(SceneError, match="ai1 2 samples every 0.002 s.*one rate"):
        rw.fit(path, None, "K")
    path.write_bytes(path.read_bytes()[:-12])
    with pytest.raises(SceneError, match="cut off.*'ai1' 2. Copy it again"):
        rw.fit(path, None, "K")


def test_a_sign_and_millivolts_are_part_of_the_sensitivity():
    forced = {"time (s)": [0.0], "CH1 (mV)": [1.0], "X [um]": [1.0]}
    columns = columns_of(list(forced), {"CH1": "force_n*100", "X [um]": "x_um*-1"})
    assert columns["force"] == (1, pytest.approx(0.1)) and columns["y"] == (2, pytest.approx(-1e-6))
    assert columns_of(["t (s)", "CH1", "CH2"], {"CH1": "x_um", "CH2": "y_um"})["z"] == (2, 1e-6)
    lengths = [columns_of(["t (s)", f"X [{unit}]"])["y"] for unit in ("m", "mm", "micron", "nm")]
    assert lengths == [(1, 1.0), (1, 1e-3), (1, 1e-6), (1, 1e-9)]
    units = columns_of(["Temps [s]", "Force (Newtons)", "Acc [m/s²]"]), columns_of(["in ms", "F(N)", "acceleration g"])
    assert [found["acceleration"][1] for found in units] == [1.0, 9.80665] and units[1]["time"] == (0, 1e-3)
    turning = columns_of(["Time [µs]", "X [um]", "Speed [Hz]"])
    assert turning["time"] == (0, 1e-6) and turning["speed"] == (2, 2.0 * np.pi)


def test_a_reader_of_damaged_files_raises_nothing_but_its_own_errors(tmp_path):
    random, path = np.random.default_rng(5), tmp_path / "file.csv"
    for _, head, row in FORMS.values():
        whole = (head + "\n".join(row.format(k=k, t=k / 8.0, ms=125.0 * k, a=0.5 * k, b=k % 7) for k in range(40))).encode()
        for _ in range(8):
            broken = bytearray(whole)
            for at in random.integers(0, len(whole), random.integers(1, 12)):
                broken[at] = random.choice([*b"\n\r\t,;\"' .-e9\x00", random.integers(256)])
            path.write_bytes(bytes(broken[: random.integers(1, len(whole) + 1)] if random.random() < 0.3 else broken))
            try:
                signals_of(path)
            except SceneError as told:
                assert str(path) in str(told)
