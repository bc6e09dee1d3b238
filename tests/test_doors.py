"""Doors of ``import raceway`` and of the command line: what is wrong is told by its name, once, and nothing is lost in silence."""

import inspect
import itertools
import json
import pickle
import runpy
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from functools import reduce
from pathlib import Path
from typing import Annotated

import numpy as np
import pytest

import raceway as rw
import raceway.core
from raceway import at_least, positive
from raceway.extend import DURATION, PATH, PATHS, ShowProgress, open_store, write_whole

SCENE = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
SOFT = {"preset": "B7206C", "balls": {"young": 1e6}}


@rw.door
def opened(
    out: Annotated[str | Path | None, PATH] = None,
    points: Annotated[int, at_least(1)] = 1,
    seed: Annotated[int, at_least(0)] = 0,
    patience: Annotated[float, DURATION] = 1.0,
    aim: Annotated[float, positive()] = 1.0,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    name: str = "",
    progress: ShowProgress = None,
):
    return out, points, seed, patience, aim, plugins, name, progress


@pytest.mark.parametrize(
    ("argument", "value", "rule"),
    [
        ("out", 3, "path"), ("out", b"x", "path"), ("out", "x\0y", "path"), ("points", 0, "at least 1"), ("points", 2.0, "whole"),
        ("points", True, "whole"), ("points", 10**12, "1e9"), ("seed", -1, "at least 0"), ("patience", float("nan"), "from 0"),
        ("patience", "3", "from 0"), ("patience", 10**400, "from 0"), ("aim", 0, "greater than 0"), ("aim", float("inf"), "finite"), ("plugins", [None], "path"), ("name", 3, "text"), ("progress", 3, "function"),
        ("progress", len, "function"), ("progress", int, "function"),
    ],
)  # fmt: skip
def test_a_wrong_argument_is_told_by_its_name(argument, value, rule):
    with pytest.raises(rw.SceneError) as caught:
        opened(**{argument: value})
    (mistake,) = caught.value.mistakes
    assert mistake.path == argument and mistake.value is value and rule in mistake.message


def test_what_means_the_same_is_converted(tmp_path):
    out, points, *_, plugins, _, _ = opened(str(tmp_path), np.int64(7), plugins=str(tmp_path))
    assert out == tmp_path and (points, type(points)) == (7, int) and plugins == [tmp_path]
    assert opened(patience=float("inf"))[3] == float("inf")
    assert opened() == (None, 1, 0, 1.0, 1.0, (), "", None)


def test_iterators_and_ranges_are_values_of_an_axis():
    for values in ((axial for axial in (300.0, 400.0)), range(300, 401, 100), map(float, (300, 400))):
        assert [row.point["load.axial"] for row in rw.compare(SCENE, {"load.axial": values}).rows] == [300, 400]
    with pytest.raises(rw.SceneError, match="10001 runs are more"):
        rw.compare(SCENE, {"load.axial": itertools.count(1)})


def test_a_door_stays_the_function_that_it_is():
    assert pickle.loads(pickle.dumps(rw.run)) is rw.run
    assert "patience" in inspect.signature(rw.run).parameters and "Parameters" in rw.run.__doc__
    with pytest.raises(TypeError, match=r"run\(\) got an unexpected keyword argument 'no_such'"):
        rw.run(SCENE, no_such=1)


def test_results_take_folders_as_text(tmp_path):
    result = rw.run(SCENE)
    assert result.save(str(tmp_path)) == [tmp_path / "result.json"]
    for wrong in (3, None, b"x", [tmp_path]):
        with pytest.raises(rw.SceneError, match="folder"):
            result.save(wrong)
    with pytest.raises(rw.SceneError, match="must be text"):
        result.gradient(3)


@pytest.mark.parametrize("threads", ["0", "-1", "many"])
def test_a_number_of_threads_that_numba_cannot_take(threads, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
    with pytest.raises(rw.RacewayError, match=f"`NUMBA_NUM_THREADS` = '{threads}': must be a whole number from 1"):
        runpy.run_path(raceway.core.__file__)


#: What is done to the rows 0, 1, 2 of a store, and their states afterwards.  A digest knows its row's number and numbers.
DAMAGES = {
    "numbers": (("UPDATE points SET content = replace(content, '1', '2') WHERE key = 1", "DELETE FROM points WHERE key = 2"),
                ["run", "waiting", "waiting"]),
    "another's": ([f"UPDATE points SET key = {new} WHERE key = {old}" for old, new in ((0, 9), (2, 0), (9, 2))],
                  ["waiting", "run", "waiting"]),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGES)
def test_damaged_rows_of_a_store_are_counted(case, tmp_path):
    axes = {"load.axial": [400.0, 600.0, 800.0], "supports.tilt": ["locked"]}  # a word: each point is a row
    assert rw.sweep(SCENE, axes, store=tmp_path / "store").attrs["damaged_rows"] == 0
    changes, states = DAMAGES[case]
    with closing(sqlite3.connect(tmp_path / "store" / "points.sqlite")) as connection, connection:
        for change in changes:
            connection.execute(change)
    with open_store(tmp_path / "store") as there, pytest.warns(UserWarning, match="2 of 3 rows are damaged"):
        found = there.to_xarray()
    assert found.attrs["damaged_rows"] == 2 and found.status.values.ravel().tolist() == states


def test_a_file_that_is_no_longer_text_or_ends_what_reads_it_is_named(tmp_path):
    rw.sweep(SCENE, {"load.axial": [400.0, 600.0]}, store=tmp_path / "store")
    file = tmp_path / "store" / "points.sqlite"
    file.write_bytes(file.read_bytes().replace(b"CREATE TABLE points", b"CREATE TABLE poi\xff\xfe\xff"))
    with pytest.raises(rw.RacewayError, match="points.sqlite"):
        rw.export_ross(tmp_path / "store")
    (tmp_path / "ends.py").write_text("raise GeneratorExit('here')\n")
    with pytest.raises(rw.PluginError, match="line 1: GeneratorExit: here"):
        rw.check(SCENE, plugins=tmp_path / "ends.py")


class Unlucky:
    """What a user may hand in by mistake: nothing that one asks of it has an answer."""

    def __repr__(self):
        raise ValueError("closed")

    def __iter__(self):
        raise OSError("closed")

    def __fspath__(self):
        raise OSError("closed")


class Closed:
    def __getattr__(self, _name):
        raise OSError("closed")


def test_a_check_of_what_no_file_can_hold_is_json():
    for value in (float("inf"), 10**400, Unlucky()):
        json.dumps(rw.check({**SCENE, "load": {"axial": value}}).to_dict(), allow_nan=False)


class BytesPath:
    def __fspath__(self):
        return b"missing.toml"


@pytest.mark.parametrize(
    ("call", "rule"),
    [
        (lambda: rw.run({**SCENE, "load": {"axial": (x for x in (1.0,))}}), "no generator"),
        (lambda: rw.run(reduce(lambda inner, _: {"a": inner}, range(3000), {})), "nested more than 32 deep"),
        (lambda: rw.run(f"[{'.'.join(['a'] * 3000)}]\nb = 1\n"), "nested more than 32 deep"),
        (lambda: rw.run(SCENE | {"bodies": {"kind": "condensed"}, "bearing": SOFT}), r"bearing.balls.young` = 1000000.0: is too soft"),
        (lambda: rw.sweep(SCENE, 3), "`axes` = 3: must be a mapping"),
        (lambda: rw.fit({}, SCENE, "load.axial", run_out=iter((1e-6, "x"))), "`run_out`.*two finite numbers"),
        (lambda: rw.fit({}, SCENE, "load.axial", columns={"x": 3}), "`columns`.*text both"),
        (lambda: write_whole(b"", Path("")), "it is a folder"),
        (lambda: rw.compare(SCENE, Unlucky()), "`vary`"),
        (lambda: rw.run(SCENE, out=Unlucky()), "`out`"),
        (lambda: rw.run(BytesPath()), "no such file"),
        (lambda: rw.make_plan(Unlucky()), "a Scene"),
        (lambda: rw.run({**SCENE, "load": {"axial": Unlucky()}}), "no Unlucky"),
        (lambda: rw.run(Unlucky()), "no Unlucky"),
        (lambda: rw.export_ross(Closed()), "Closed is no sweep"),
        (lambda: rw.sweep(SCENE, dict), "`axes`"),
        (lambda: rw.fit({"axial [N]": [10**400]}, SCENE, "load.axial"), "not a number"),
        (lambda: rw.sensitivities(SCENE, ["load.axial"])["load.radial"], "must be one of 'load.axial'"),
        (lambda: rw.fit({"axial [N]": [400.0, 1000.0], "kxx [N/um]": [39.4, 67.4]}, SCENE, "bearing.contact_angle_deg")["K"], "must be one of"),
    ],
)  # fmt: skip
def test_what_no_argument_can_be_is_refused_in_words(call, rule):
    with pytest.raises(rw.RacewayError, match=rule):
        call()


@pytest.mark.parametrize("long", ["x" * 5000, "/".join(["y" * 300] * 3), "a." * 200 + "b"])
def test_names_that_no_system_takes(long, tmp_path, monkeypatch):
    """Beyond 255 letters a system does not say that nothing is there: it refuses the question."""
    monkeypatch.chdir(tmp_path)
    result = rw.run(SCENE)
    for call in (
        lambda: result.save(long),
        lambda: rw.run(long),
        lambda: rw.run(SCENE, out=long),
        lambda: rw.law("hertz").picture(long),
        lambda: rw.compare(SCENE, {"load.axial": [400.0, 800.0]}, kept=long),
    ):
        with pytest.raises(rw.RacewayError, match="too long|neither a file"):
            call()


class Bolts(rw.Answer):
    """A third party's answer, with an argument that the package's own methods have, too, and a method that is a door."""

    stem = "bolts"

    def line(self, row, seed, out="here"):
        return row, seed, out

    @rw.door
    def torque(self, bolts: Annotated[int, at_least(2)], grip: Annotated[float | None, positive()] = None) -> float:
        return bolts * (grip or 1.0)


def test_others_read_at_their_own_parameters_alone_and_show_plain_types():
    assert Bolts().line(3, -1, 5) == (3, -1, 5)
    assert list(inspect.signature(Bolts().line).parameters) == ["row", "seed", "out"]
    assert Bolts().torque(np.int64(3), None) == 3.0 and Bolts().torque(2, grip=0.5) == 1.0
    for arguments, words in (((1,), "`bolts` = 1: must be a whole number below 1e9, at least 2"), ((2, 0), "`grip`")):
        with pytest.raises(rw.SceneError, match=words):
            Bolts().torque(*arguments)
    assert str(inspect.signature(Bolts.torque)) == "(self, bolts: int, grip: float | None = None) -> float"


def test_annotations_that_are_no_text_are_read_alike():
    def far(metres, feet=1.0): ...

    far.__annotations__ = {"metres": Annotated[float, positive(), "of another program"], "feet": float | None}
    with pytest.raises(rw.SceneError, match="`metres` = -1: must be a finite number, greater than 0"):
        rw.door(far)(-1)


def test_aliases_of_markers_are_read_at_every_function_that_has_them():
    fronts = [one for name in rw.__all__ if inspect.isfunction(one := getattr(rw, name))]
    told = [one for one in fronts if "progress" in inspect.signature(one).parameters]
    assert len(told) > 8
    for one in told:
        needed = [SCENE for p in inspect.signature(one).parameters.values() if p.default is p.empty]
        with pytest.raises(rw.SceneError, match="`progress` = 3|`over`"):  # which is read before
            one(*needed, progress=3)


def test_no_signature_of_the_package_shows_a_marker():
    for name in rw.__all__:
        assert not inspect.isroutine(one := getattr(rw, name)) or "Annotated" not in str(inspect.signature(one)), name
