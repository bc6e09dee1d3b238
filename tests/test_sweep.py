"""`raceway sweep`: designs, the store, what it survives, executors, continuation."""

import csv
import itertools
import json
import os
import resource
import sqlite3
import sys
import time
from contextlib import closing, contextmanager, suppress
from typing import Any

import attrs
import numpy as np
import pytest

from checks.validation.command_line import ARTICLE, EXAMPLES, invoke
from checks.validation.scenes import built_in
from raceway import PluginError, RacewayError, SceneError, __version__, scene_from_dict
from raceway import sweep as front
from raceway.extend import Refused, open_store, read_toml, tables_at, written
from raceway.points.axes import Design, design_file, grid, listed_points, parse_axes
from raceway.points.dataset import values_of
from raceway.points.engine import Work
from raceway.points.store import facts_digest
from raceway.points.sweep import Point, prepare
from raceway.points.sweep import fill_store as study
from raceway.testing import default_registry, run
from tests.deadly_work import Deadly

Dask, Processes, Serial = (built_in("executor", name) for name in ("dask", "processes", "serial"))

SCENE: dict[str, Any] = {
    "title": "test",
    "bearing": {"preset": "B7206C"},
    "rotor": {"mass": 2.0},
    "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 6.39e-4, "load_share": 0.5},
    "integrator": {"kind": "quasi_static", "turns": 1, "steps_per_turn": 24},  # each point is a run
}


def rows_of(path):
    with open_store(path) as store:
        return [(row["point"], row["status"], row["reason"], row["values"]) for row in store.rows()]


def swept(folder, design, executor=None, tables=SCENE, **options):
    retry = options.pop("retry_failed", False)
    study(prepare(tables, design, folder, **options), executor or Serial(), retry).close()
    return rows_of(folder)


def altered(folder, statement):
    with closing(sqlite3.connect(folder / "s" / "points.sqlite")) as file, file:
        file.execute(statement)


@attrs.frozen
class Stopping(Serial):
    """Ctrl-C after some batches."""

    after: int = 3

    def compute(self, work, batches):
        for count, answer in enumerate(super().compute(work, batches)):
            if count == self.after:
                raise KeyboardInterrupt
            yield answer


def test_a_grid_is_numbered_like_its_product():
    texts = ["load.axial=400,800", "excitation.speed_rpm=1000:9000:9", "supports.tilt=locked,free"]
    design = grid(texts)
    assert list(design.points()) == list(Design(parse_axes(texts)).points())
    assert Design.from_dict(json.loads(json.dumps(design.to_dict()))) == design


def test_lists_and_design_files(tmp_path):
    wanted = [{"load.axial": 400, "supports.tilt": "locked"}, {"load.axial": 1.5e3, "supports.tilt": "free"}]
    texts = {
        "a.csv": "# loads\nload.axial, supports.tilt\n400, locked\n\n1.5e3, free\n",
        "a.json": json.dumps(wanted),
        "a.toml": '[[points]]\nload.axial = 400\nsupports.tilt = "locked"\n[[points]]\n"load.axial" = 1.5e3\nsupports.tilt = "free"\n',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert list(design_file(tmp_path / name).points()) == wanted, name
    assert list(design_file(tmp_path / "a.toml").points()) == wanted
    (tmp_path / "grid.toml").write_text('[grid]\n"load.axial" = "400:1200:3"\nsupports.tilt = ["locked", "free"]\n')
    assert design_file(tmp_path / "grid.toml") == grid(["load.axial=400:1200:3", 'supports.tilt="locked","free"'])


@pytest.mark.parametrize(("name", "text", "word"), [
    ("a.txt", "", "must end in one of .csv, .json, .toml"), ("a.csv", "", "has no points"),
    ("a.csv", "load.axial\n", "has no points"), ("a.csv", "load.axial,b.c\n1\n", "has 1 values for 2 keys"),
    ("a.json", "{", "is not valid JSON"), ("a.json", "[1]", "must hold a list of points"),
    ("a.json", '[{"load.axial": 1}, {"load.radial": 1}]', "not in all: load.axial, load.radial"),
    ("a.json", '[{"a..b": 1}]', "is not a key of a scene"), ("a.toml", "x = 1", "must be a TOML file with a table"),
    ("missing.csv", None, "cannot be read"),
])  # fmt: skip
def test_bad_lists_are_refused(tmp_path, name, text, word):
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=word):
        design_file(tmp_path / name)


def test_bad_designs_are_refused_before_anything_is_written(tmp_path):
    store = tmp_path / "store"
    for design, word in (
        (grid(["load.axail=1,2"]), "unknown key.*did you mean 'axial'"),
        (grid(["load.axial=1,x"]), "load.axial"),
        (listed_points([{"load.axial": 1.0}, {"load.axial": "x"}]), "point 2: load.axial"),
    ):
        with pytest.raises(SceneError, match=word):
            prepare(SCENE, design, store)
    # A refusal of a whole table is that of the one value in it that was changed.
    with pytest.raises(SceneError, match="`bearing.ball_count` = 400: bearing: "):
        prepare(SCENE, grid(["bearing.ball_count=14,400"]), store)
    with pytest.raises(SceneError, match="nothing is varied"):
        grid([])
    with pytest.raises(SceneError, match="has no values"):
        grid(["load.axial="])
    assert not store.exists()


def test_values_are_those_of_single_runs_labelled_with_units(tmp_path):
    import xarray

    design = grid(["excitation.speed_rpm=11000,14000", "load.axial=500,1000"])
    found = swept(tmp_path / "s", design)
    assert [status for _, status, _, _ in found] == ["run"] * 4
    for point, _, _, values in found:
        single = run(scene_from_dict(tables_at(SCENE, point, default_registry())))
        assert values == values_of(single)
    with open_store(tmp_path / "s") as store:
        data = store.to_xarray()
        assert store.status() == {"waiting": 0, "done": 4, "failed": 0, "computed": 0, "total": 4}
    assert dict(data.sizes) == {"excitation.speed_rpm": 2, "load.axial": 2, "dof": 5, "dof2": 5}
    one = data.sel({"excitation.speed_rpm": 14000, "load.axial": 500})
    assert one["z_real"] == found[2][3]["z_real"] and one["z_real"].attrs["units"] == "N/m"
    assert one["stiffness"].sel(dof="y", dof2="y") == found[2][3]["stiffness"][1][1]
    assert data["load.axial"].attrs["units"] == "N" and data["excitation.speed_rpm"].attrs["units"] == "r/min"
    assert all(data[name].attrs.get("long_name") for name in data.variables if name not in ("dof", "dof2"))
    assert json.loads(data.attrs["scene"])["rotor"]["mass"] == 2.0
    assert json.loads(data.attrs["plugins"])["integrator:quasi_static"].startswith("raceway ")
    from raceway.points.dataset import write_netcdf

    with open_store(tmp_path / "s") as store, xarray.open_dataset(write_netcdf(store)) as read:
        assert read.equals(data) and read.attrs["program"] == data.attrs["program"]


def test_a_static_scene_and_a_list_have_what_they_have(tmp_path):
    static = {name: table for name, table in SCENE.items() if name not in ("excitation", "integrator")}
    listed = listed_points(
        [{"load.axial": 500.0, "supports.tilt": "free"}, {"load.axial": 900.0, "supports.tilt": "locked"}]
    )
    swept(tmp_path / "s", listed, tables=static)
    with open_store(tmp_path / "s") as store:
        data = store.to_xarray()
    assert data.sizes["point"] == 2 and "z_real" not in data and "p0" in data
    assert data["supports.tilt"].values.tolist() == ["free", "locked"]
    assert float(data["displacement"].sel(dof="x")[1]) > float(data["displacement"].sel(dof="x")[0]) > 0.0


def test_what_is_finished_survives_a_stop_and_is_not_computed_again(tmp_path):
    design = grid(["excitation.speed_rpm=10980:15000:8"])
    whole = swept(tmp_path / "whole", design)
    with pytest.raises(KeyboardInterrupt):
        swept(tmp_path / "s", design, Stopping())
    with open_store(tmp_path / "s") as store:
        states = store.status()
    assert states == {"waiting": 5, "done": 3, "failed": 0, "computed": 0, "total": 8}

    with pytest.raises(RacewayError, match=r"3 of 8 points done: go on with --resume"):
        prepare(SCENE, design, tmp_path / "s")
    assert swept(tmp_path / "s", design, Stopping(after=100), resume=True) == whole

    # Nothing is left to do: no batch is asked for.
    assert swept(tmp_path / "s", design, Stopping(after=0), resume=True) == whole


DAMAGES = {
    "a digit of a value": ("UPDATE points SET content = replace(content, '1', '2') WHERE key = 1", {1}),
    "no JSON any more": ("UPDATE points SET content = substr(content, 1, 40) WHERE key = 2", {2}),
    "another state": ("UPDATE points SET state = 'failed' WHERE key = 0", {0}),
    "a row of another point": (
        "UPDATE points SET content = (SELECT content FROM points WHERE key = 0), "
        "digest = (SELECT digest FROM points WHERE key = 0) WHERE key = 3",
        {3},
    ),
    "no row": ("DELETE FROM points WHERE key = 1", {1}),
    "another number": ("UPDATE points SET key = 70 WHERE key = 2", {2}),
}


@pytest.mark.parametrize(("statement", "damaged"), DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_row_is_computed_again(statement, damaged, tmp_path):
    design = grid(["load.axial=500,600,700,800"])
    whole = swept(tmp_path / "s", design)
    altered(tmp_path, statement)
    with open_store(tmp_path / "s") as store:
        read = [row for row in store.rows() if row["status"] == "run"]
    assert len(read) == 4 - len(damaged), "nothing that is damaged is read as a value"
    with pytest.warns(UserWarning, match=f"{len(damaged)} rows of the store are damaged"):
        assert swept(tmp_path / "s", design, resume=True) == whole


def test_a_missing_row_does_not_move_the_values_of_the_others(tmp_path):
    swept(tmp_path / "s", grid(["load.axial=500,600,700,800"]))
    with open_store(tmp_path / "s") as store:
        whole = store.to_xarray()["z_real"].values
    altered(tmp_path, "DELETE FROM points WHERE key = 1")
    with open_store(tmp_path / "s") as store:
        found = store.to_xarray()["z_real"].values
    assert np.isnan(found[1]) and (found[[0, 2, 3]] == whole[[0, 2, 3]]).all()


def test_pages_that_were_swapped_are_told(tmp_path):
    """Each row is sound, but found at another place, or by one way and not by another."""
    design = grid(["excitation.speed_rpm=12000:13000:12"])
    swept(tmp_path / "s", design)
    with open_store(tmp_path / "s") as store:
        whole = store.to_xarray()["z_real"].values
    path = tmp_path / "s" / "points.sqlite"
    content, seen = path.read_bytes(), 0
    pages = [content[k : k + 4096] for k in range(0, len(content), 4096)]
    for i, j in itertools.pairwise(range(3, len(pages))):
        swapped = list(pages)
        swapped[i], swapped[j] = pages[j], pages[i]
        path.write_bytes(b"".join(swapped))
        with pytest.raises(RacewayError, match="Begin again|choose another folder"):
            swept(tmp_path / "s", design, resume=True)
        with suppress(RacewayError), open_store(tmp_path / "s") as store:
            found = np.asarray(store.to_xarray().get("z_real", np.nan))
            assert (np.isnan(found) | (found == whole)).all()
            seen += 1
    assert seen


def test_rows_of_another_store_are_computed_again(tmp_path):
    """Whole, each at its number, with its digest: they are another load's."""
    design = grid(["excitation.speed_rpm=12000,13000"])
    whole = swept(tmp_path / "s", design)
    swept(tmp_path / "other", design, tables={**SCENE, "load": {"axial": 900.0}})
    with closing(sqlite3.connect(tmp_path / "s" / "points.sqlite")) as file, file:
        file.execute("ATTACH ? AS other", (str(tmp_path / "other" / "points.sqlite"),))
        file.execute("UPDATE points SET (content, cost, digest) = "
                     "(SELECT content, cost, digest FROM other.points AS there WHERE there.key = points.key)")  # fmt: skip
    with pytest.warns(UserWarning, match="2 rows of the store are damaged"):
        assert swept(tmp_path / "s", design, resume=True) == whole


def test_damaged_facts_are_refused(tmp_path):
    swept(tmp_path / "s", grid(["load.axial=500,600"]))
    for change in ("replace(value, '500', '501')", "substr(value, 1, 3)"):
        altered(tmp_path, f"UPDATE facts SET value = {change}")
        with pytest.raises(RacewayError, match="is damaged"):
            open_store(tmp_path / "s")


@contextmanager
def small_files():
    """No file of this process can grow beyond 40 kB for a while."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_disk_that_is_full_before_the_first_block_is_written_holds_nothing_and_says_so(tmp_path):
    tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}}
    with (
        small_files(),
        pytest.raises(RacewayError, match=r"Nothing is stored: free some space, and run the command again\.$"),
    ):
        front(tables, {"load.axial": "500:1500:400"}, store=tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_a_full_disk_keeps_what_is_finished(tmp_path):
    design = grid(["excitation.speed_rpm=10980:15000:24"])
    with (
        small_files(),
        pytest.raises(RacewayError, match=r"Finished points are stored: free .*again, a sweep with --resume"),
    ):
        swept(tmp_path / "s", design)
    with open_store(tmp_path / "s") as store:
        assert 0 < store.status()["done"] < 24
    assert swept(tmp_path / "s", design, resume=True) == swept(tmp_path / "whole", design)


def test_points_that_fail_keep_their_reason_and_are_tried_again_when_asked(tmp_path):
    design = grid(["supports.tilt=locked", "load.axial=0,500", "excitation.kind=bidirectional,unidirectional"])
    found = swept(tmp_path / "s", design)
    assert [status for _, status, _, _ in found] == ["failed", "failed", "run", "run"]
    assert "no load acts" in found[0][2] and not found[0][3]
    assert swept(tmp_path / "s", design, Stopping(after=0), resume=True) == found
    with pytest.raises(KeyboardInterrupt):
        swept(tmp_path / "s", design, Stopping(after=0), resume=True, retry_failed=True)
    with open_store(tmp_path / "s") as store:
        assert store.status()["waiting"] == 2
    done = invoke("sweep", ARTICLE, "--grid", "load.axial=0", "--grid", "rotor.mass=1,2", "--out", tmp_path / "t", "--json")
    assert done.exit_code == 1 and "all 2 points failed" in json.loads(done.stdout)["errors"][0]["message"]


def test_a_store_of_something_else_is_named_and_left_alone(tmp_path):
    design = grid(["load.axial=500,600"])
    whole = swept(tmp_path / "s", design)
    heavier = {**SCENE, "rotor": {"mass": 3.0}}
    with pytest.raises(RacewayError, match=r"another scene \(rotor.mass: 2.0 there, 3.0 here\).*not overwritten"):
        prepare(heavier, design, tmp_path / "s", resume=True)
    with pytest.raises(RacewayError, match=r"another sweep \(axes.load.axial: \[500, 600\] there, \[500, 600, 700\] here\)"):
        prepare(SCENE, grid(["load.axial=500,600,700"]), tmp_path / "s", resume=True)
    with pytest.raises(RacewayError, match=r"another sweep \(axes.rotor.mass: None there, \[2, 3\] here\)"):
        prepare(SCENE, grid(["load.axial=500,600", "rotor.mass=2,3"]), tmp_path / "s", resume=True)
    assert rows_of(tmp_path / "s") == whole
    with closing(sqlite3.connect(tmp_path / "s" / "points.sqlite")) as file, file:
        (text,) = file.execute("SELECT value FROM facts WHERE name = 'identity'").fetchone()
        old = {**json.loads(text), "raceway": "0.0.9"}
        file.execute("UPDATE facts SET value = ? WHERE name = 'identity'", (json.dumps(old),))
        texts = dict(file.execute("SELECT name, value FROM facts").fetchall())
        file.execute("UPDATE facts SET value = ? WHERE name = 'digest'", (json.dumps(facts_digest(texts)),))
    before = (tmp_path / "s" / "points.sqlite").read_bytes()
    with pytest.raises(RacewayError, match=rf"another version \(raceway {__version__} instead of 0.0.9\)"):
        prepare(SCENE, design, tmp_path / "s", resume=True)
    assert (tmp_path / "s" / "points.sqlite").read_bytes() == before
    (tmp_path / "strange").mkdir()
    (tmp_path / "strange" / "points.sqlite").write_text("not a data base at all, " * 50)
    with pytest.raises(RacewayError, match="is not a store"):
        prepare(SCENE, design, tmp_path / "strange", resume=True)
    with pytest.raises(RacewayError, match="no store of a sweep"):
        open_store(tmp_path)


def test_warnings_of_points_are_kept_and_summed_up(tmp_path):
    words = [
        "sweep", ARTICLE, "--set", "integrator.kind=periodic", "--set", "rotor.damping=0", "--grid",
        "load.axial=30,60",
    ]  # fmt: skip
    out = tmp_path / "s"
    shown = invoke(*words, "--out", out, "--resume", "--csv")
    assert shown.exit_code == 0 and "holds no sweep to resume: a new one is started" in shown.stderr
    with open_store(out) as store:
        told = [row["warnings"] for row in store.rows()]
        counts = store.to_xarray()["warnings"].values
    assert told[0] and counts.tolist() == [len(one) for one in told]
    assert "points warn: " in shown.stdout and "(first at load.axial = 30)" in " ".join(shown.stdout.split())
    first = next(csv.DictReader((out / "results.csv").open()))
    assert (first["reason"], first["warnings"]) == ("", "; ".join(told[0]))
    rows = json.loads(invoke(*words, "--out", out, "--resume", "--json").stdout)["rows"]
    assert [row.get("warnings", []) for row in rows] == told


def test_two_sweeps_do_not_write_one_store(tmp_path):
    prepared = prepare(SCENE, grid(["load.axial=500,600"]), tmp_path / "s")
    with written(prepared.store, prepared.facts), pytest.raises(RacewayError, match="is being written by another process"):
        study(prepared, Serial())


def test_a_worker_without_the_plugin_or_of_another_version_refuses(tmp_path):
    prepared = prepare(SCENE, grid(["load.axial=500,600"]), tmp_path / "s")
    wanted = prepared.facts["identity"]
    for changed, words in (
        ({"plugins": {**wanted["plugins"], "contact_law:mine": "raceway-mine 1.0"}}, "contact law 'mine' of raceway-mine 1.0 is missing"),
        ({"plugins": {**wanted["plugins"], "contact_law:hertz": "raceway 9.9"}}, f"contact law 'hertz' is of raceway {__version__} instead of raceway 9.9"),
        ({"numpy": "1.0", "program": "x"}, "instead of 1.0"),
        ({"program": "y"}, "at the same version"),
    ):  # fmt: skip
        answer = Work(Point(SCENE), (), {**wanted, **changed})([(0, {"load.axial": 500.0})])
        assert isinstance(answer, Refused) and words in answer.reason

    class Elsewhere(Serial):
        def compute(self, work, batches):
            for number, _ in batches:
                yield number, Refused("host:1", "contact law 'mine' is missing")

    with pytest.raises(PluginError, match="worker host:1 cannot compute these points: contact law 'mine' is missing"):
        study(prepared, Elsewhere())


GROWN: list[bytes] = []


def grown(_points):
    """400 MB more, over the second that loky waits before it looks."""
    GROWN.append(bytes([1]) * 400_000_000)
    time.sleep(1.2)
    return os.getpid()


@pytest.mark.slow
def test_a_process_that_grows_is_not_replaced():
    answers = dict(Processes(workers=1).compute(grown, [(0, []), (1, [])]))
    assert answers[0] == answers[1] != os.getpid()


def test_executors_say_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(PluginError, match=r"pip install '\.\[sweep\]'"):
        list(Dask().compute(Deadly(), []))


def test_the_command(tmp_path):
    options = "--set integrator.kind=quasi_static --grid load.axial=500,600 --out"
    words = ["sweep", ARTICLE, *options.split(), tmp_path / "s"]
    shown = invoke(*words, "--csv")
    assert shown.exit_code == 0 and "2 points: 2 done" in shown.output
    lines = (tmp_path / "s" / "results.csv").read_text().splitlines()
    assert len(lines) == 3 and lines[0].startswith("load.axial,status,reason,warnings,z_real")
    assert (tmp_path / "s" / "results.nc").stat().st_size > 0
    content = json.loads(invoke(*words, "--resume", "--json").stdout)
    assert content["axes"] == [{"key": "load.axial", "values": [500, 600]}] and content["store"] == str(tmp_path / "s")
    assert set(content["rows"][0]) - {"warnings"} == {"point", "status", "values"}
    values = content["rows"][0]["values"]
    stated = [values["equivalent_stiffness"], values["z_real"], values["stiffness"][1][1]]  # K, Re Z, kyy
    line = next(line for line in shown.output.splitlines() if line.split()[:1] == ["500"])
    assert line.split()[1:4] == [f"{1e-6 * value:.3f}" for value in stated]
    for more, word in (
        (["--executor", "seriall"], "did you mean 'serial'"),
        (["--workers", "3"], "executor 'serial' has no --workers"),
        (["--list", "x.csv"], "contradict each other"),
    ):
        refused = invoke(*words, *more)
        assert refused.exit_code == 2 and word in refused.output


def test_the_map_of_hardening_has_the_trend_of_an_independent_solver():
    # physics: fixed balls with centrifugal force, half the rig's unbalance towards ball 0, no ring growth; the printed
    # ratios have three digits, the printed stiffness three or four: half a digit is 0.3 % of the smallest.
    tables = {**read_toml(EXAMPLES / "hardening_map.toml"), "kinematics": {"gyroscopic": "none", "ring_growth": False}}
    axes = {"supports.tilt": ["locked", "free"], "load.axial": [400, 2000], "excitation.speed_rpm": [10980, 15000]}
    k = front(tables, axes).equivalent_stiffness
    for tilt, load, first, ratio in (
        ("locked", 400, 163.0e6, 0.668), ("locked", 2000, 285.8e6, 0.993), ("free", 400, 24.32e6, 1.356), ("free", 2000, 48.37e6, 1.063),
    ):  # fmt: skip
        slow, fast = k.sel({"supports.tilt": tilt, "load.axial": load}).values
        assert slow == pytest.approx(first, rel=3e-3) and fast / slow == pytest.approx(ratio, abs=1e-3)


def test_the_command_tries_failed_points_again(tmp_path, monkeypatch):
    asked, words = [], ("--grid", "load.axial=900,1000", "--set", "identifier.kind=tangent", "--out", tmp_path)
    monkeypatch.setattr("raceway.points.sweep.fill_store", lambda *given: (asked.append(given[2]), study(*given))[1])
    for again in ((), ("--resume",), ("--retry-failed",)):
        assert invoke("sweep", EXAMPLES / "minimal.toml", *words, *again).exit_code == 0
    assert asked == [False, False, True]
