"""Arrays kept on disk: found again, never mistaken, whole or made anew, by several processes, within a size."""

import json
import subprocess
import sys

import numpy as np
import pytest

from checks.validation.command_line import PATIENCE_S, invoke, python
from raceway.storage import array_cache
from raceway.storage.array_cache import kept

INPUTS = {"points": np.arange(6.0).reshape(3, 2), "count": 3, "seat": "clamped", "ratio": 0.29, "offsets": None}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    array_cache._warn.cache_clear()
    yield tmp_path / "arrays"
    array_cache._warn.cache_clear()


class Maker:
    def __init__(self):
        self.calls = 0

    def __call__(self):
        self.calls += 1
        return {"a": np.arange(12.0).reshape(3, 4)[:, ::2], "b": np.array([7], dtype=np.int32)}


def get(maker, inputs=INPUTS, kind="test", sources=("scene/tables.py",)):
    return kept(kind, "arrays of a test", inputs, sources, maker)


def test_a_second_use_reads_what_the_first_made(folder):
    make = Maker()
    first, second = get(make), get(make)
    assert make.calls == 1
    for found in (first, second):
        assert np.array_equal(found["a"], [[0.0, 2.0], [4.0, 6.0], [8.0, 10.0]])
        assert found["a"].flags.c_contiguous and found["b"].dtype == np.int32
    assert len(list(folder.iterdir())) == 1


CHANGES = {
    "points": INPUTS["points"] + 1e-16 * np.arange(6).reshape(3, 2), "count": 3.0, "seat": 5e11, "ratio": 0.29 + 1e-16,
    "offsets": [0, 1],
}  # fmt: skip


@pytest.mark.parametrize("name", CHANGES)
def test_every_input_counts(name):
    make = Maker()
    get(make)
    get(make, {**INPUTS, name: CHANGES[name]})
    assert make.calls == 2


def test_kind_sources_shapes_and_nesting_count():
    make = Maker()
    get(make)
    get(make, kind="other")
    get(make, sources=("errors.py",))
    get(make, {**INPUTS, "points": INPUTS["points"].reshape(2, 3)})
    get(make, {**INPUTS, "offsets": [[1, 2], [3]]})
    get(make, {**INPUTS, "offsets": [[1], [2, 3]]})
    assert make.calls == 6


def test_what_is_no_value_cannot_be_a_key():
    with pytest.raises(TypeError, match="dict"):
        get(Maker(), {"inputs": {}})


#: What is left of a file's content.
HARMS = {
    "cut": lambda content: content[:-5],
    "a bit flipped": lambda content: content[:-9] + bytes([content[-9] ^ 1]) + content[-8:], "empty": lambda content: b"",
    "another head": lambda content: b'{"kind": 3}\n' + content.split(b"\n", 1)[1],
}  # fmt: skip


@pytest.mark.parametrize("harm", HARMS.values(), ids=HARMS)
def test_a_damaged_file_is_made_anew_and_said(folder, harm):
    make = Maker()
    get(make)
    path = next(folder.iterdir())
    path.write_bytes(harm(path.read_bytes()))
    with pytest.warns(RuntimeWarning, match="damaged"):
        found = get(make)
    assert make.calls == 2 and found["a"][2, 1] == 10.0
    get(make)
    assert make.calls == 2


def test_a_folder_that_cannot_be_written_costs_one_warning(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path / "file"))
    make = Maker()
    with pytest.warns(RuntimeWarning, match="RACEWAY_CACHE_DIR") as caught:
        get(make)
        found = get(make)
    assert len(caught) == 1 and make.calls == 2 and found["a"][0, 1] == 2.0


#: Half of a megabyte, so that a writer is seen in the middle; both wait for the other to have started.
RACE = """
import sys, time
import numpy as np
from raceway.storage.array_cache import kept
start = float(sys.argv[1])
for i in range(20):
    time.sleep(max(0.0, start + 0.02 * i - time.time()))
    found = kept("race", "a race", {"round": i}, ("errors.py",), lambda: {"a": np.full(65536, float(i))})
    assert found["a"].shape == (65536,) and (found["a"] == i).all(), i
print("whole")
"""


def test_two_processes_may_make_the_same_entries_at_once(folder):
    import time

    words = [sys.executable, "-W", "error", "-c", RACE, str(time.time() + 1.0)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    both = [subprocess.Popen(words, **pipes) for _ in range(2)]
    for process in both:
        out, err = process.communicate(timeout=PATIENCE_S)
        assert out == "whole\n", err
    names = [path.name for path in folder.iterdir()]
    assert len(names) == 20 and all(name.endswith(".arrays") for name in names)


def test_an_entry_under_another_name_is_made_anew(folder):
    """Its digest is right, its key is not: these are another material's arrays."""
    get(Maker())
    get(Maker(), {**INPUTS, "ratio": 0.30})
    first, second = sorted(folder.iterdir())
    first.write_bytes(second.read_bytes())
    make = Maker()
    with pytest.warns(RuntimeWarning, match="is damaged"):
        get(make), get(make, {**INPUTS, "ratio": 0.30})
    assert make.calls == 1


@pytest.mark.parametrize("mode", [0o777, 0o757, 0o775])
def test_a_folder_that_others_may_write_is_not_used(folder, mode):
    get(Maker())
    folder.chmod(mode)
    folder.parent.chmod(0o755)
    array_cache._warn.cache_clear()
    make = Maker()
    with pytest.warns(RuntimeWarning, match="are not stored: others may write in"):
        get(make), get(make)
    assert make.calls == 2


def test_the_least_recently_used_go_first(folder, monkeypatch):
    import os

    monkeypatch.setattr(array_cache, "LIMIT", 2500)

    def entry(i):
        return kept("size", f"entry {i}", {"i": i}, ("errors.py",), lambda: {"a": np.full(100, float(i))})

    for i in range(3):
        entry(i)
        for path in folder.iterdir():
            status = path.stat()
            os.utime(path, (status.st_atime - 10.0, status.st_mtime - 10.0))
        entry(0)  # used again each time
    assert sorted(e.what for e in array_cache.entries()) == ["entry 0", "entry 2"]
    assert sum(e.bytes for e in array_cache.entries()) <= 2500


def test_what_a_killed_process_left_goes_when_it_is_old(folder):
    import os

    get(Maker())
    old, new = folder / ".key.1.abc", folder / ".key.2.def"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (1.0, 1.0))
    get(Maker(), kind="other")
    assert not old.exists() and new.exists()
    assert len(array_cache.entries()) == 2


def test_the_command_shows_and_clears(folder):
    assert json.loads(invoke("dev", "cache", "--json").stdout)["arrays"] == []
    assert "Compliances of bodies" in invoke("dev", "cache").stdout
    get(Maker())
    (folder / "broken.arrays").write_bytes(b"\x00\n")
    found = json.loads(invoke("dev", "cache", "--json").stdout)
    assert {(e["kind"], e["what"]) for e in found["arrays"]} == {("test", "arrays of a test"), ("damaged", "broken.arrays")}
    assert found["arrays_bytes"] == sum(p.stat().st_size for p in folder.iterdir())
    assert "arrays of a test" in invoke("dev", "cache").stdout
    cleared = json.loads(invoke("dev", "cache", "--clear", "--json").stdout)
    assert cleared["arrays"] == [] and cleared["arrays_bytes"] == 0
    assert not folder.exists()


def test_the_command_reads_no_arrays():
    """Heads of files alone: numpy stays out."""
    found = python(
        "-c", "import sys; from raceway.storage import array_cache; array_cache.entries(); print('numpy' in sys.modules)"
    )
    assert found.stdout == "False\n", found.stderr


def test_a_disk_without_room_costs_one_warning_and_no_answer(folder, monkeypatch):
    usage = array_cache.shutil.disk_usage("/")
    monkeypatch.setattr(array_cache.shutil, "disk_usage", lambda place: usage._replace(free=100))
    make = Maker()
    with pytest.warns(
        RuntimeWarning, match="GiB to write, .* GiB free on the disk.*free space by raceway dev cache --clear"
    ):
        found = get(make)
    assert (found["a"] == make()["a"]).all()
    assert not list(folder.glob("*"))


def test_arrays_are_aligned_and_mapped_not_copied(folder):
    """BLAS copies what is not aligned; an entry may be as large as the memory."""
    get(Maker())
    for array in get(Maker()).values():
        assert array.ctypes.data % 64 == 0
        assert not array.flags.owndata and not array.flags.writeable
