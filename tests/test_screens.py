"""Screens show what results hold: they change units and count, and compute nothing else."""

import ast
import json
import pickle
import re
from functools import cache
from pathlib import Path

import attrs
import numpy as np
import pytest
from rich.console import Console

import raceway as rw
from checks.validation.command_line import ARTICLE, EXAMPLES, MINIMAL, invoke
from raceway.answers.quantities import C
from raceway.answers.table import in_a_line
from raceway.extend import Words, duration, equilibrium_table, rows_table
from raceway.framework.estimate import Estimate, few_words
from raceway.pipeline.run_parts import bodies_rows, cost_row, equilibrium_rows, loaded_balls, mounting_rows
from raceway.testing import b7206c, settled

PACKAGE = Path(__file__).parents[1] / "raceway"
SCREENS = [*PACKAGE.glob("pipeline/run_parts.py"), *PACKAGE.rglob("*screen.py")]
#: What ``raceway verify`` sorts its rows by, and does not show.
SORTED_BY = {"verify": ["row['error'] / row['tolerance']"]}


def number(node):
    """A literal or a constant's name, or arithmetic of such: a factor of units."""
    if isinstance(node, ast.BinOp):
        return number(node.left) and number(node.right)
    if isinstance(node, ast.Name):
        return node.id.isupper() and len(node.id) > 3
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def count(node):
    """How many there are, plain or less another count."""
    if isinstance(node, ast.BinOp):
        return count(node.left) or count(node.right)
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "len"


@pytest.mark.parametrize("path", SCREENS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_screen_changes_units_and_counts_only(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    arithmetic = [
        n for n in ast.walk(tree) if isinstance(n, ast.BinOp) and isinstance(n.op, ast.Mult | ast.Div | ast.Sub | ast.Pow)
    ]
    computed = [ast.unparse(n) for n in arithmetic if not (number(n.left) or number(n.right) or count(n))]
    assert computed == SORTED_BY.get(path.parent.name, []), "compute it where the result is made, and name it there"
    imported = {alias.name for n in ast.walk(tree) if isinstance(n, ast.Import | ast.ImportFrom) for alias in n.names}
    modules = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)} | imported
    assert not modules & {"math", "cmath", "numpy"}


def test_what_the_screen_of_a_run_shows_is_in_its_result(tmp_path):
    words = ("--set", "supports.tilt=free", "--set", "bearing.radial_clearance=3e-5", "--out", tmp_path)
    found = invoke("run", ARTICLE, *words)
    assert found.exit_code == 0, found.stderr
    text, result = " ".join(found.stdout.split()), json.loads((tmp_path / "result.json").read_text())
    equilibrium, identification = result["equilibrium"], result["identification"]
    assert f"kyy tilts follow {1e-6 * equilibrium['kyy_tilts_follow_n_per_m']:.3g} N/µm" in text
    assert f"contact angle {equilibrium['free_contact_angle_deg']:.5g} deg, from the clearance" in text
    wide = identification["dynamic_stiffness_imag_error"]
    # Im Z = w C: both errors are one.
    speed = 2.0 * np.pi * identification["frequency_hz"]
    assert wide == pytest.approx(speed * identification["equivalent_damping_error"])


@pytest.mark.parametrize("tilt", ["free", 3e4])
def test_tilts_that_follow_are_condensed_statically(tilt):
    """Against the response of all three coordinates to a radial force alone."""
    root = np.random.default_rng(5).normal(size=(5, 5))
    k = root @ root.T + np.eye(5)
    held = [1, 3, 4]
    supported = k + np.diag([0.0, 0.0, 0.0, *(2 * [0.0 if tilt == "free" else tilt])])
    moved = np.linalg.solve(supported[np.ix_(held, held)], [1.0, 0.0, 0.0])

    def followed(stiffness, tilt):
        model, still = settled(b7206c(supports={"tilt": tilt}))
        return equilibrium_table(model, attrs.evolve(still, stiffness=stiffness))["kyy_tilts_follow_n_per_m"]

    assert followed(k, tilt) == pytest.approx(1.0 / moved[0], rel=1e-10)
    assert followed(k, "locked") is None
    assert followed(np.diag([1.0, 2.0, 3.0, 0.0, 0.0]), "free") == 2.0


def lines(renderable, width=80):
    console = Console(width=width)
    with console.capture() as captured:
        console.print(renderable, crop=False)
    return [line.rstrip() for line in captured.get().splitlines()]


def test_the_answer_stands_first(tmp_path):
    found = invoke("run", MINIMAL, "--out", tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())["identification"]
    text = found.stdout.splitlines()
    heads = [line for line in text if not line.startswith((" ", "warning", "written", "B7206C: "))]
    force = f"{result['force_amplitude_n']:.4g} N bidirectional"
    assert heads[heads.index(f"Answer at 12000 r/min, {force}, tilt locked") + 1] == "Equilibrium under 1000 N axial"
    assert len(text) <= 24 and text[1].startswith("Answer at")
    place = next(k for k, line in enumerate(text) if line.startswith("  equivalent stiffness K"))
    assert place == 2 and f"{1e-6 * result['equivalent_stiffness']:.3g} N/µm" in text[place]
    assert [line.split("  ")[1].strip() for line in text[place:] if line.startswith("  ")][0] == "equivalent stiffness K"


OIL = {"oil": "VG 32", "temperature_c": 50.0}
PAIR = {"preset": "7014C", "arrangement": "DB", "preload": 290.0}
TURNING = {"kind": "bidirectional", "speed_rpm": 9000.0, "amplitude": "constant", "force": 100.0}
FILM = {
    "bearing": PAIR, "supports": {"tilt": "free"}, "load": {"radial": [100.0, 0.0]}, "excitation": TURNING, "lubricant": OIL,
    "contact": {"kind": "film", "damping": "band"}, "quantities": {"film_parameter": {"roughness": 1e-7}},
}  # fmt: skip
WARM = {
    "bearing": {**PAIR, "preload_kind": "spring"}, "kinematics": {"spin_speed_rpm": 9000.0}, "lubricant": {"oil": "VG 32"},
    "mounting": {"shaft_interference": 5e-6}, "heat": {"oil_inlet_c": 25.0, "oil_flow": "300 cm3/min", "ambient_c": 25.0},
}  # fmt: skip
#: Kinds of scenes, each with all that a user of it asks for.
KINDS = {
    "at rest": {"bearing": {"preset": "6205"}, "load": {"axial": 300.0, "radial": [1000.0, 0.0]}, "supports": {"tilt": "free"}},
    "along a line": {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "excitation": {**TURNING, "kind": "unidirectional"}},
    "film and friction": FILM, "warm": WARM, "sliding": {**FILM, "bearing": {**PAIR, "preload": 2.0}, "load": {}},
}  # fmt: skip


@cache
def ran(kind):
    return rw.run(KINDS[kind])


def assert_one_screen(result):
    """The answer on the fourth line at the latest, 28 lines with the file's name, warnings a line each; numbers keep their units."""
    told = lines(result.screen(["raceway-out/title/result.json"]))
    answer = next(k for k, line in enumerate(told, 1) if re.match("  (equivalent stiffness K|tangent kxx) ", line))
    assert answer <= 4 and len(told) <= 28 and max(map(len, told)) <= 80
    assert sum(line.startswith("warning: ") for line in told) == len(result.warnings)
    assert not any(re.search(r"[+-] …$", line) for line in told) and told[-1].startswith("written: ")


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_scene_fits_one_screen(kind):
    assert_one_screen(ran(kind))


def test_what_a_screen_has_no_room_for_is_told_when_it_is_asked_for(caplog):
    result = ran("film and friction")
    short = lines(result.screen())
    with caplog.at_level("INFO", "raceway"):
        whole = " ".join(lines(result.screen()))
    assert "-v or result.json" in " ".join(short) and "…" not in whole and "-v or" not in whole
    told = ("Palmgren's rule", "torque by source", "reference life L10r", "stability", "BPFO")
    assert all(words in whole for words in told)
    assert not any("Palmgren" in line for line in short)


def test_a_line_that_is_cut_ends_at_a_part_of_its_sentence_or_at_a_word():
    assert in_a_line("short", 20) == "short"
    words = "word " * 10
    assert in_a_line(f"a part of a sentence: {words}", 40) == "a part of a sentence …"
    assert in_a_line(f"a: {words}", 40) == f"a: {'word ' * 7}…"


def test_what_is_nothing_has_no_sign_and_a_direction_is_no_state():
    """A loose row carries 0 N; a ring that the balls push off its seat is not said to be seated."""
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 100.0}
    loose = rw.run({"bearing": pair, "load": {"axial": 1000.0}}).to_dict()
    rows = {name: (value, remark) for name, value, remark in equilibrium_rows(loose)}
    assert rows["axial force of rows"][0] == "1000, 0 N"
    single = {"bearing": {"preset": "B7206C"}, "load": {"axial": 100.0}}
    fast = rw.run({**single, "kinematics": {"spin_speed_rpm": 3e4}}).to_dict()
    value, remark = equilibrium_rows(fast)[1][1:]
    assert value.startswith("-") and remark == "axial, + preloads the bearing"


def test_notes_are_short_on_the_screen_and_sentences_in_the_result(tmp_path):
    screen = invoke("run", MINIMAL, "--set", "integrator.kind=newmark", "--out", tmp_path).stdout
    error = json.loads((tmp_path / "result.json").read_text())["error"]
    assert "Hann" in error["how"]["transient"] and "Hann" not in screen
    assert error["short"].keys() == error["how"].keys() and all(len(words) <= 48 for words in error["short"].values())
    assert f"of Z {error['total']:.1e}, most by time step" in " ".join(screen.split())


@pytest.mark.parametrize("estimate", Estimate, ids=lambda one: one.name)
def test_numbers_of_a_note_stay_and_clauses_go(estimate):
    values = dict.fromkeys(("size", "stiffness", "approach", "bound", "ripple", "rpm"), 0.0012)
    values |= {"steps": 90, "count": 181, "order": 2, "kind": "ramp", "part": "transient"}
    values |= dict.fromkeys(("reasons", "change", "why", "how", "transient"), "a reason: with a clause, and another one")
    note = estimate(**values)
    assert len(note.short) <= 95 and len(note.short) <= len(note) and note.estimate is estimate
    assert pickle.loads(pickle.dumps(note)).short == note.short
    assert few_words("a plain sentence: with a clause") == "a plain sentence: with a clause"


def test_a_static_scene_has_one_line_for_what_it_cannot_tell(tmp_path):
    scene = tmp_path / "static.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n')
    text = invoke("run", scene, "--out", tmp_path / "out").stdout
    assert "not estimated" not in text and text.count("without [excitation]") == 1
    answer = text[text.index("Answer") : text.index("Equilibrium")]
    assert all(words in answer for words in ("tangent kxx", "tangent kyy", "all balls, each"))
    assert "loaded ball" not in text  # under an axial load alone all carry the same: told once
    text = invoke("run", scene, "--set", "load.radial=[100.0, 0.0]", "--out", tmp_path / "out").stdout
    assert "most loaded ball" in text[: text.index("Equilibrium")]
    assert "least loaded ball" in text and "all balls" not in text


def test_an_orbit_along_a_line_has_no_second_axis(tmp_path):
    words = ("--set", "excitation.kind=unidirectional", "--set", "integrator.kind=periodic", "--out", tmp_path)
    text = invoke("run", ARTICLE, *words).stdout
    orbit = json.loads((tmp_path / "result.json").read_text())["identification"]["orbit"]
    assert f"{1e6 * orbit['major_m']:.4g} x 0 µm  synchronous (1x), a line" in text


def test_a_pair_is_called_one_and_its_balls_have_rows(tmp_path):
    found = invoke("run", EXAMPLES / "duplex_db.toml", "-v", "--set", "load.radial=[50.0, 0.0]", "--out", tmp_path)
    text = " ".join(found.stdout.split())
    result = json.loads((tmp_path / "result.json").read_text())
    loads = [ball["load_outer_n"] for ball in result["equilibrium"]["balls"]]
    count = result["scene"]["bearing"]["ball_count"]
    row, ball = divmod(int(np.argmax(loads)), count)
    assert "pair DB, back to back: two rows of these balls, 16 mm apart, preload 290 N before mounting (rigid)" in text
    assert result["equilibrium"]["largest_ball_load_race"] == "outer"
    assert f"most loaded ball {max(loads):.5g} N row {row + 1}, ball {ball} at" in text
    inner = result["equilibrium"]["balls"][int(np.argmax(loads))]["load_inner_n"]
    assert f"; outer {1e-6 * result['equilibrium']['largest_pressure_outer_pa']:.0f} MPa" in text
    assert f"; inner {inner:.5g} N, " in text
    assert f"preload {result['equilibrium']['preload']['running_n']:.5g} N" in text


def test_rows_have_the_numbers_by_whose_names_they_go():
    """Of results whose numbers all differ."""
    model = {
        "elasticity": [[-0.11, None], [None, -0.22]], "compliance": {"inner_m_per_n": 1.1e-9, "outer_m_per_n": 2.2e-9, "contact_angle_deg": 15.5},
        "inertia": {"inner_supported_hz": 3e3, "inner_supported_error": 1e-3, "outer_supported_hz": 2e3, "outer_supported_error": 2e-3},
    }  # fmt: skip
    assert [row[1:] for row in bodies_rows(model)[1:]] == [
        ("-11.0 %, -22.0 %", "against rigid rings and balls"), ("1.10, 2.20 nm/N", "inner, outer over Hertz, 15.5 deg"),
        ("2 kHz", "outer ring, off by 2.0e-03"),
    ]  # fmt: skip
    preload = {"running_n": 310.0, "mounted_n": 305.0, "before_mounting_n": 300.0, "second_before_mounting_n": 300.0}
    preload |= {"rows_n": [320.0, 290.0], "lift_off_axial_n": [900.0, None], "lift_off_row": [2, None]}
    assert [row[1:] for row in mounting_rows({"preload": preload, "held_axial": None})] == [
        ("310 N", "running; 300 N before, 305 mounted"), ("320, 290 N", "under the loads"), ("900 N, never", "row 2 along +x"),
    ]  # fmt: skip
    loads, names = ((5.0, 6.0), (9.0, 12.0), (2.0, 3.0), (7.0, 8.0)), ("inner", "outer")
    ball = dict.fromkeys((f"contact_angle_{race}_deg" for race in names), 15.0) | {
        f"peak_pressure_{race}_pa": 1e9 for race in names
    }
    balls = [
        ball | {"row": 1 + k // 2, "azimuth_deg": 90.0 * k, "load_inner_n": i, "load_outer_n": o}
        for k, (i, o) in enumerate(loads)
    ]
    most, least = loaded_balls({"equilibrium": {"balls": balls, "largest_ball_load_race": "outer"}}, ["most", "least"])
    assert most[1:] == ("12 N", "row 1, ball 1 at 90 deg; outer 1000 MPa, 15.00 deg; inner 9 N, 1000 MPa, 15.00 deg")
    assert least[1:] == ("2 N", "row 2, ball 0 at 180 deg; inner 1000 MPa, 15.00 deg")
    damping = {"equivalent_damping": 3.0, "equivalent_damping_error": 4.0}
    assert C.fact({"identification": damping})[1:] == ("not resolved", f"below its error of 4 N s/m; {C.words}")


def test_a_table_says_once_what_is_the_same_in_all_rows():
    rows = [{"axial": "400", "speed_rpm": f"{speed}", "K N/µm": 153.2} for speed in (12000, 15000)]
    text = lines(rows_table(rows))
    assert text[0] == "same in all rows: axial 400, K N/µm 153.2"
    assert text[1].split() == ["speed", "r/min"] and text[3:] == ["      12000", "      15000"]
    assert "the same" not in lines(rows_table(rows[:1]))[0]


def named_twice(column):
    """Words that stand twice in a column with numbers."""
    if not any(re.match(r"[-+]?\d", cell) for cell in column.cells):
        return set()
    return {cell for cell in column.cells if re.match("[a-z]", cell) and column.cells.count(cell) > 1}


def test_a_state_that_a_column_of_numbers_repeats_is_named_once_below_it():
    states = ["1.5", "not resolved", "failed", "not resolved", "failed", "not resolved", "waiting"]
    rows = [{"load": str(k), "C N s/m": state, "K": state} for k, state in enumerate(states)]
    text = lines(rows_table(rows))
    assert text[-1] == "-: not resolved (C N s/m, K); --: failed (C N s/m, K)" and "\n".join(text).count("waiting") == 2
    assert [line.split()[1:] for line in text[3:6]] == [["-", "-"], ["--", "--"], ["-", "-"]]
    words = lines(rows_table([{"kind": kind, "tilt": "free" if k else "locked"} for k, kind in enumerate("aabb")]))
    assert "-:" not in words[-1]  # words of a column without numbers are its values
    none = lines(rows_table([{"C": value} for value in (None, 2.0, "lost", "lost")]))
    assert none[-1] == "--: lost (C)" and none[-2].strip() == "--" and none[-5].strip() == "-"


@pytest.mark.parametrize(
    "words",
    [
        ("run", MINIMAL, "-v"),
        ("compare", ARTICLE, "--vary", "excitation.speed_rpm=9000,12000", "--vary", "excitation.kind=unidirectional,bidirectional"),
        ("compare", MINIMAL, "--vary", "bearing.ball_count=12,16,17"),
        ("sweep", MINIMAL, "--grid", "load.axial=1000,1e9,2e9"),
        ("follow", EXAMPLES / "folds.toml", "--over", "excitation.speed_rpm=9000:9500", "--points", "5"),
        ("band", MINIMAL, "--tolerance", "load.axial=±10 %", "--by", "load.axial"),
    ],
    ids=lambda words: words[0],
)  # fmt: skip
def test_no_table_of_a_screen_names_a_state_twice(words, tmp_path, monkeypatch):
    tables, make = [], rows_table
    monkeypatch.setattr("raceway.answers.table.rows_table", lambda *given: tables.append(make(*given)) or tables[-1])
    found = invoke(*words, *("--out", tmp_path))
    assert (tables or words[0] == "run") and not any(named_twice(column) for made in tables for column in made.columns)
    for made in tables:
        dashes = {cell for column in made.columns for cell in column.cells if cell and set(cell) == {"-"}}
        assert all(f"{sign}: " in made.below for sign in dashes)
        assert " ".join(made.below.split()) in " ".join(found.stdout.split())
        assert not {"status", "note"} & {column.head for column in made.columns}


@pytest.mark.parametrize("width", [40, 80, 120])
@pytest.mark.parametrize("columns", [3, 9, 30])
def test_a_table_of_any_width_keeps_every_number_whole(width, columns):
    made = np.random.default_rng(columns)
    rows = [
        {f"quantity_{k} [N/µm]": float(made.normal() * 10.0 ** made.integers(-9, 9)) for k in range(columns)}
        for _ in range(4)
    ]
    rows = [
        {"name": f"a setting of many words, the {k}th of four", "by": f"central_difference, speed of {k} m/s in film", **row}
        for k, row in enumerate(rows)
    ]
    text = lines(rows_table(rows), width)
    assert max(map(len, text)) <= width
    words = " ".join(text).split()
    assert all(f"{value:.5g}" in words for row in rows for value in row.values() if isinstance(value, float))
    assert re.findall(r"^(\d) ", "\n".join(text), re.M) == ["1", "2", "3", "4"] * words.count("#")


def test_a_line_ends_neither_in_a_number_nor_before_its_unit():
    text = "rows under the loads 1044.4, 44.442 N; m = 0.061 kg at 12000 r/min, +- 5e-06 N/µm, an orbit of 15.66 x 12.2 µm, C 3 N s/m"
    for width in range(16, 80):
        told = lines(Words(text), width)
        assert " ".join(told) == text and max(map(len, told)) <= width
        for whole in ("44.442 N;", "m = 0.061 kg", "12000 r/min,", "+- 5e-06 N/µm,", "15.66 x 12.2 µm,", "3 N s/m"):
            assert any(whole in line for line in told), (width, whole)


#: Units of input and of column headers, names of cases and quantities, which stored rows are found by; screens write the former with the sign.
NAMES_IN_ASCII = ["scene/units.py", "storage/headings.py", "verify/study.py"]
NAMES_IN_ASCII += ["fit/fit.py", "fit/column_headers.py", "fit/response.py"]


@pytest.mark.parametrize("sources", ["raceway/*/**/*.py", "packages/*/raceway_*/**/*.py"])
def test_micrometres_are_written_one_way(sources):
    written, paths = {}, list(PACKAGE.parent.glob(sources))
    assert len(paths) > 50
    for path in paths:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        texts = [n for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        told = [n.value for n in texts if re.search(r"\bum\b", n.value) and n.value not in documented(tree)]
        if told and "/".join(path.parts[-2:]) not in NAMES_IN_ASCII:
            written["/".join(path.parts[-2:])] = told
    assert not written


def documented(tree):
    """Docstrings of a module and all that is in it."""
    nodes = (n for n in ast.walk(tree) if isinstance(n, ast.Module | ast.ClassDef | ast.FunctionDef))
    return {
        n.body[0].value.value
        for n in nodes
        if n.body and isinstance(n.body[0], ast.Expr) and isinstance(n.body[0].value, ast.Constant)
    }


def test_a_cost_says_whether_compiled_kernels_were_kept_and_the_processor_time():
    cost = {"wall_s": 12.0, "cpu_s": 3.0, "compile_s": 9.0, "steps": 40, "peak_memory_bytes": 2**30, "threads": 1}
    name, wall, words = cost_row({**cost, "compiled_kept": True})
    assert wall == "12 s" and "3 CPU-s" in words and "compiling 9 s, cached" in words
    assert "compiling 9 s, not cached" in cost_row({**cost, "compiled_kept": False})[2]
    assert "compiling" not in cost_row({**cost, "compile_s": 0.0, "compiled_kept": True})[2]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.853, "0.85 s"), (99.0, "99 s"), (100.0, "2 min"), (3600.0, "1 h"), (21012.0, "5 h 50 min"), (90000.0, "1 d 1 h")],
)
def test_a_time_is_said_in_the_units_of_people(seconds, words):
    assert duration(seconds) == words


def test_changes_of_a_scene_are_named_in_two_lines_at_most(caplog):
    keys = ["rotor.mass", "excitation.speed_rpm", "excitation.load_share", "excitation.reference_speed_rpm", "load.axial"]
    values = [2.0, 9000, 0.5, 10980, 1200]
    changes = [f"{key}={value}" for key, value in zip(keys, values, strict=True)]
    more = ["excitation.unbalance=6.39e-4", "supports.tilt=free", "contact.damping=1e-3", "integrator.kind=periodic"]
    result = rw.run(rw.load_scene(EXAMPLES / "minimal.toml", [*changes, *more]))
    short = lines(result.screen())
    with caplog.at_level("INFO", "raceway"):
        assert all(key in " ".join(lines(result.screen())) for key in keys)
    assert short[1].endswith("…") and short[2].startswith("Answer at 9000 r/min")
