"""Files without an end, too large ones and those that unpack to gigabytes are refused in one message, before memory goes."""

import base64
import os
import resource
import struct
import tracemalloc
import zlib

import numpy as np
import pytest
from raceway_measure.fit.signals import signals_of

from checks.validation.cubes import block
from checks.validation.scenes import built_in
from raceway import MeshError, RacewayError, SceneError, scene_from_dict
from raceway.extend import memory_for, read_numbers, row_key, size_words
from raceway.points.axes import design_file
from raceway.storage import number_table
from raceway.testing import b7206c, default_registry

Abaqus = built_in("format", "abaqus")
Vtu = built_in("format", "vtu")
Gmsh = built_in("mesher", "gmsh")

BEARING = scene_from_dict(b7206c()).bearing


def measured(path):
    return scene_from_dict(b7206c(excitation={"kind": "measured", "file": str(path), "speed_rpm": 12000.0}))


READERS = {
    "measured force": (".csv", measured), "record": (".csv", signals_of), "vtu": (".vtu", Vtu().read),
    "inp": (".inp", Abaqus().read), "msh": (".msh", built_in("format", "msh")().read),
    "points of a sweep": (".csv", design_file), "plug-in": (".py", default_registry().load_file),
    "step": (".step", lambda path: Gmsh(ball=str(path)).mesh(BEARING)),
}  # fmt: skip


@pytest.mark.parametrize(
    "endless", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")], ids=["a pipe", "a link to zeros"]
)
@pytest.mark.parametrize("reader", READERS)
def test_a_file_without_an_end_is_refused(reader, endless, tmp_path):
    suffix, read = READERS[reader]
    path = tmp_path / f"file{suffix}"
    endless(path)
    with pytest.raises(RacewayError) as caught:
        read(path)
    message = str(caught.value)
    assert str(path) in message and "pipes and devices are not read" in message and "\n" not in message
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("reader", READERS)
def test_a_file_that_is_too_large_is_refused_before_it_is_read(reader, tmp_path):
    suffix, read = READERS[reader]
    path = tmp_path / f"file{suffix}"
    with path.open("wb") as file:
        file.truncate(2**41)  # takes no room on the disk
    with pytest.raises(RacewayError, match="has .* GiB; at most .* are read"):
        read(path)


def table(path, rows):
    lines = [f"{k * 1e-4:.6f},{np.cos(k):.9f},{np.sin(k):.9f}" for k in range(rows)]
    path.write_text("t,Fy,Fz\n" + "\n".join(lines))
    return path


def test_finished_rows_belong_to_what_a_file_of_the_scene_holds(tmp_path):
    keys = [row_key(measured(table(tmp_path / "force.csv", rows)), default_registry()) for rows in (60, 61, 60)]
    assert keys[0] == keys[2] != keys[1]


def test_a_long_record_takes_less_than_twice_its_size_in_memory(tmp_path, monkeypatch):
    """Three numbers of 8 bytes for 31 characters, their lines' numbers, and parts that are small beside them."""
    monkeypatch.setattr(number_table, "_PART", 2**14)
    path = table(tmp_path / "long.csv", 50_000)
    tracemalloc.start()
    try:
        values = read_numbers(path, lambda header: None).values
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert values.shape == (50_000, 3) and values[-1, 1] == pytest.approx(np.cos(49_999), abs=1e-9)
    assert peak < 2 * path.stat().st_size


@pytest.mark.parametrize("part", [16, 64, 2**22])
def test_the_parts_in_which_a_file_is_read_change_nothing(part, tmp_path, monkeypatch):
    """Empty lines, quotes and what only Python takes for numbers; the last line ends without a sign."""
    monkeypatch.setattr(number_table, "_PART", part)
    path = tmp_path / "odd.csv"
    path.write_bytes(b'\xef\xbb\xbf\r\na, b\r\n1,2\r\n\r\n"3", 4\n 1_0,1e2\r\n5,6')
    found = read_numbers(path, lambda header: None)
    assert found.header == ["a", "b"]
    assert found.values.tolist() == [[1.0, 2.0], [3.0, 4.0], [10.0, 100.0], [5.0, 6.0]]
    assert found.lines.tolist() == [3, 5, 6, 7]
    path.write_text("a,b\n1,2\n\n3\n")
    with pytest.raises(ValueError, match="line 4: 2 numbers are needed, found '3'"):
        read_numbers(path, lambda header: None)
    for first, last in (".,", ",."):  # the decimal sign is that of all parts: of 3, 11 or all 34 rows
        path.write_text("t;a\n" + f"1;2{first}5\n" * 33 + f"1;2{last}5\n")
        with pytest.raises(ValueError, match="line 35: commas and points"):
            read_numbers(path, lambda header: None)


def test_a_header_that_is_refused_is_refused_before_its_rows(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text("t,volts\n" + "not a number\n" * 20)
    with pytest.raises(SceneError, match="the first line must name t and some of"):
        measured(path)


@pytest.mark.parametrize("line", ["*INCLUDE, INPUT=/dev/zero", "*include,input=more.inp", " *Include , INPUT=more.inp"])
def test_a_mesh_that_includes_another_file_is_refused(line, tmp_path):
    path = tmp_path / "deck.inp"
    Abaqus().write(path, block())
    path.write_text("*HEADING\n** no *INCLUDE here\n" + line + "\n" + path.read_text())
    with pytest.raises(MeshError, match=r"deck.inp', line 3: \*INCLUDE is not supported"):
        built_in("mesher", "file")(inner_ring=str(path)).mesh(BEARING)


def bomb(path):
    """A cell whose field inflates a thousand times, block by block of 16 MiB."""
    Vtu().write(path, block())
    zeros = zlib.compress(bytes(2**24), 9)
    blocks = 12
    head = struct.pack(f"<{3 + blocks}I", blocks, 2**24, 0, *[len(zeros)] * blocks)
    text = base64.b64encode(head).decode() + base64.b64encode(zeros * blocks).decode()
    field = f'<PointData><DataArray type="UInt8" Name="nodes:x" format="binary">{text}</DataArray>'
    path.write_text(path.read_text().replace("</Piece>", field + "</PointData></Piece>"))


def generated(path):
    Abaqus().write(path, block())
    path.write_text(path.read_text() + "*NSET, NSET=ALL, GENERATE\n1, 2000000000, 1\n")


@pytest.mark.parametrize(("suffix", "write", "read"), [(".vtu", bomb, Vtu().read), (".inp", generated, Abaqus().read)])
def test_a_mesh_that_unpacks_to_gigabytes_is_refused_before_they_are_taken(suffix, write, read, tmp_path, monkeypatch):
    monkeypatch.setattr("raceway.storage.files._MORE", 2**26)  # of gigabytes, which take seconds
    path = tmp_path / f"bomb{suffix}"
    write(path)
    before = resource.getrlimit(resource.RLIMIT_AS)
    with pytest.raises(MeshError, match="unpack to more memory than a mesh of that size needs") as caught:
        read(path)
    assert "\n" not in str(caught.value)
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_memory_is_limited_while_a_file_is_read_only():
    with memory_for(0), pytest.raises(MemoryError):
        np.ones(2**28)
    with memory_for(2**26):  # 40 times its size
        np.empty(2**27)


def test_sizes_are_told_with_their_unit():
    assert [size_words(x) for x in (7, 2048, 3 * 2**20, 5.5 * 2**30)] == ["7 bytes", "2 KiB", "3 MiB", "5.5 GiB"]
