"""Meshes from files and from Gmsh: sets, other solids, and files that are not what they should be."""

import re
import signal
from pathlib import Path

import attrs
import meshio
import numpy as np
import pytest
from raceway_meshing.formats import used_only

from checks.validation.command_line import EXAMPLES
from checks.validation.cubes import block
from checks.validation.scenes import built_in
from checks.validation.solids import write, write_msh
from checks.validation.squeezed import squeezed
from raceway import MeshError, SceneError, load_scene, scene_from_dict
from raceway.extend import mesh_bodies, resolve
from raceway.plugins.bodies.mesh import check_sets
from raceway.scene.tables import Supports

Abaqus = built_in("format", "abaqus")
Msh = built_in("format", "msh")
Vtu = built_in("format", "vtu")
Gmsh = built_in("mesher", "gmsh")
File = built_in("mesher", "file")

BEARING = load_scene(EXAMPLES / "minimal.toml").bearing


@pytest.mark.parametrize("form", [Vtu(), Abaqus(), Msh()], ids=lambda f: f.name)
def test_a_format_keeps_a_mesh_and_names_files_of_no_use(form, tmp_path):
    mesh, path = block(), tmp_path / f"body{form.suffixes[0]}"
    mesh = attrs.evolve(mesh, points=mesh.points + 1e-3 * np.random.default_rng(2).standard_normal(mesh.points.shape))
    getattr(form, "write", write_msh)(path, mesh)
    back = form.read(path)
    # VTU and gmsh keep every bit; CalculiX reads 20 characters of a number, which hold eleven figures.
    np.testing.assert_allclose(back.points, mesh.points, rtol=5e-11 if form.name == "abaqus" else 0.0, atol=0.0)
    assert np.array_equal(back.cells, mesh.cells)
    assert np.array_equal(back.facets("outside"), mesh.facets("outside"))
    assert np.array_equal(back.nodes("corner"), mesh.nodes("corner"))
    kind = {"file_format": "gmsh22"} if form.name == "msh" else {}
    meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])]).write(path, **kind)
    with pytest.raises(MeshError, match=rf"{path.name}.*not hexahedra of 8 nodes: 1 of type tetra.*subdivision"):
        form.read(path)
    for content in (b"", b"\x00\xff nothing of the kind \xfe" * 9, None):
        path.unlink() if content is None else path.write_bytes(content)
        with pytest.raises(MeshError, match=path.name) as told:
            form.read(path)
        assert not str(told.value).endswith(": ")


@pytest.mark.needs("ccx")
@pytest.mark.parametrize("formulation", ["one_point", "full", "incompatible"])
def test_calculix_computes_with_what_is_written(formulation, tmp_path):
    said, found, exact = squeezed(formulation, tmp_path)
    assert "Job finished" in said and "*ERROR" not in said and "*WARNING" not in said
    assert found == pytest.approx(exact, rel=1e-6)  # the program prints seven figures


def test_an_abaqus_file_names_elements_of_steel_and_numbers_of_twenty_characters(tmp_path):
    """Hybrid elements (H) are for incompressible solids, and CalculiX has none."""
    mesh = block()
    mesh = attrs.evolve(mesh, points=-np.pi * 1e-130 * mesh.points)
    for formulation, word in (("one_point", "C3D8R"), ("full", "C3D8"), ("incompatible", "C3D8I")):
        Abaqus(formulation).write(tmp_path / "body.inp", mesh)
        text = (tmp_path / "body.inp").read_text()
        assert re.findall(r"TYPE=(C3D\w+)", text) == [word]
        data = [line.split(",") for line in text.splitlines()[2:] if line[0] != "*"]
        assert max(len(number.strip()) for line in data for number in line) <= 20
        assert max(len(line) for line in data) <= 16


def test_an_abaqus_file_written_by_hand(tmp_path):
    path = tmp_path / "hand.inp"
    nodes = "\n".join(f"{10 + i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(block(1, 1, 1).points))
    order = ", ".join(str(10 + n) for n in block(1, 1, 1).cells[0])
    text = f"*Heading\n*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8R, ELSET=All\n7, {order}\n*NSET, NSET=Fixed\n10, 11\n"
    text += "*SURFACE, NAME=Race, TYPE=ELEMENT\nALL, S2\n*STEP\n"
    path.write_text(text)
    mesh = Abaqus().read(path)
    assert mesh.nodes("Fixed").tolist() == [0, 1] and mesh.facets("Race").tolist() == [[0, 1]]
    path.write_text(text.replace("ALL, S2", "Alll, S2"))
    with pytest.raises(MeshError, match="surface 'Race' has the line 'Alll, S2'.*Known element sets: all"):
        Abaqus().read(path)
    Abaqus().write(path, block())
    path.write_text(path.read_text() + "*ELSET, ELSET=Fixed_end\n1, 2, 3\n")
    with pytest.warns(UserWarning, match=r"hand.inp': element sets fixed_end are ignored"):
        Abaqus().read(path)


def test_sets_of_an_abaqus_file_are_on_the_elements_of_their_numbers(tmp_path):
    """Nodes and elements in several blocks, numbered from above, shells between them; sets in parts, of ranges and of other sets."""
    mesh, path = block(1, 1, 4), tmp_path / "parts.inp"
    nodes = [f"{50 - i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(mesh.points)]
    bricks = [f"{90 - 10 * i}, {', '.join(str(50 - n) for n in cell)}" for i, cell in enumerate(mesh.cells)]
    head, lines = "*ELEMENT, TYPE=C3D8", ["*NODE, NSET=Low", *nodes[:8], "*NODE", *nodes[8:]]
    lines += [head, bricks[0], "*ELEMENT, TYPE=S4, ELSET=Skin", f"7, {', '.join(str(50 - n) for n in mesh.cells[0][:4])}"]
    lines += [head + ", ELSET=Some", bricks[1], head, bricks[2], head + ", ELSET=some", bricks[3]]
    lines += [
        "*ELSET, ELSET=Range, GENERATE", "70, 90, 10", "*ELSET, ELSET=Both", "Skin,", "some", "*ELSET, ELSET=Both", "90",
    ]  # fmt: skip
    lines += ["*NSET, NSET=More", "LOW, 42", "** sets", *(f"*SURFACE, NAME={n}\n{n}, S2" for n in ("Some", "Range", "Both"))]
    path.write_text("\n".join(lines))
    with pytest.warns(UserWarning, match="element sets skin are ignored"):
        back = Abaqus().read(path)
    assert np.array_equal(back.points, mesh.points) and np.array_equal(back.cells, mesh.cells)
    for name, cells in (("Some", [1, 3]), ("Range", [0, 1, 2]), ("Both", [0, 1, 3])):
        assert sorted(back.facets(name).tolist()) == [[cell, 1] for cell in cells]
    assert back.nodes("Low").tolist() == [*range(8)] and back.nodes("More").tolist() == [*range(9)]
    for twice, word in ((nodes[0], "node 50"), (bricks[0], "element 90")):
        path.write_text("\n".join(lines).replace(twice, f"{twice}\n{twice}"))
        with pytest.raises(MeshError, match=rf"parts.inp' cannot be read: .*{word} is given twice"):
            Abaqus().read(path)


def test_points_without_a_cell_go_and_leave_sets_on_theirs(tmp_path):
    body = block()
    points, low = np.concatenate([[[9.0, 9.0, 9.0]], body.points, [[8.0, 8.0, 8.0]]]), [0, 3, 5, len(body.points) + 1]
    kept = used_only(tmp_path / "made up", points, body.cells + 1, {"low": low}, {})
    assert kept.points.tolist() == body.points.tolist() and kept.nodes("low").tolist() == [2, 4]


@pytest.fixture
def given(tmp_path):
    Abaqus().write(tmp_path / "body.inp", block())
    return str(tmp_path / "body.inp")


def test_sets_are_mapped_and_the_ball_is_placed(given):
    meshes = File(inner_ring=given, ball=given, scale=1e-3, sets={"inner_ring": {"raceway": "outside"}}).mesh(BEARING)
    assert list(meshes) == ["inner_ring", *(f"ball_{i:02d}" for i in range(12))]
    ring = meshes["inner_ring"]
    assert ring.facet_areas("raceway").sum() == pytest.approx(22e-6, rel=1e-12)
    assert len(ring.nodes("raceway")) == len(ring.nodes("outside"))
    # The ball's own origin lies at its place on the pitch circle; ball 3 of 12 stands on +z.
    corner = meshes["ball_03"].points[meshes["ball_03"].nodes("corner")][0]
    assert corner == pytest.approx([0.0, 0.0, 0.5 * BEARING.pitch_diameter], abs=1e-12)


APART = np.concatenate([block().points, block().points + [0.1, 0.0, 0.0]])
#: Meshes that a body's file must not hold: body, changes of a block, sets of the scene, words.
UNUSABLE = {
    "no such set": ("inner_ring", {}, {"raceway": "outsid"}, r"`mesh.sets.inner_ring.raceway`: .*no facet set 'outsid' \(did you mean 'outside'\?\)"),
    "empty set": ("inner_ring", {"facet_sets": {"hollow": []}}, {"raceway": "hollow"}, "facet set 'hollow' is empty"),
    "inside out": ("inner_ring", {"points": block().points * [1, 1, -1]}, {}, r"inner_ring \(body.vtu\).*60 of 60 cells.*inverted"),
    "all balls": ("ball", {"points": APART, "cells": np.concatenate([block().cells, block().cells + len(APART) // 2])}, {},
                  r"`mesh.ball` = .*2 parts.* file of one ball about its centre: x rolling"),
}  # fmt: skip


@pytest.mark.parametrize("case", UNUSABLE)
def test_meshes_that_are_no_body(case, tmp_path):
    body, change, sets, words = UNUSABLE[case]
    path = str(tmp_path / "body.vtu")
    Vtu().write(path, attrs.evolve(block(), **change))
    with pytest.raises(MeshError, match=words):
        File(**{body: path}, sets={body: sets} if sets else {}).mesh(BEARING)


@pytest.mark.parametrize(("mesher", "name", "words"), [
    (File, "body.obj", "no format has the ending '.obj'"), (File, "gone.vtu", "does not exist"),
    *(
        pytest.param(Gmsh, name, words, marks=pytest.mark.needs("gmsh"))
        for name, words in (
            ("bad.step", "not a STEP file"),
            ("gone.step", "does not exist"),
            ("x.iges", "reads .step"),
            ("cut.step", "cut.step' cannot be meshed: Could not read"),
        )
    ),
])  # fmt: skip
def test_files_of_no_use(mesher, name, words, tmp_path, capfd):
    (tmp_path / "bad.step").write_text("nothing of the kind")
    (tmp_path / "cut.step").write_text("ISO-10303-21; nothing more")
    with pytest.raises(MeshError, match=words):
        mesher(ball=str(tmp_path / name)).mesh(BEARING)
    said = capfd.readouterr()
    assert said.out == "" and said.err == ""  # a reader's own complaints would spoil --json


def test_scenes_name_files_beside_them(given, tmp_path):
    mesh = 'kind = "file"\nscale = 1e-2\ninner_ring = "body.inp"\nsets = {inner_ring = {raceway = "outside"}}\n'
    (tmp_path / "scene.toml").write_text(f'[bearing]\npreset = "B7206C"\n[mesh]\n{mesh}')
    assert mesh_bodies(resolve(load_scene(tmp_path / "scene.toml")))["inner_ring"].volume() == pytest.approx(6e-6)
    for more, words in (({}, "names no body"), ({"ball": "b.inp", "sets": {"bal": {}}}, r"did you mean 'ball'")):
        with pytest.raises(SceneError, match=words):
            scene_from_dict({"bearing": {"preset": "B7206C"}, "mesh": {"kind": "file", **more}})


def test_elastic_bodies_name_the_file_and_the_set_that_it_lacks(given):
    ring = {"raceway": "outside", "seat": "outside"}
    whole = {"inner_ring": ring, "outer_ring": ring, "ball": {"surface": "outside"}}

    def told(lacks, name, **supports):
        sets = {body: {k: v for k, v in known.items() if (body, k) != (lacks, name)} for body, known in whole.items()}
        mesher = File(inner_ring=given, outer_ring=given, ball=given, scale=1e-3, sets=sets)
        check_sets(mesher, mesher.mesh(BEARING), Supports(**supports))

    told("", "")
    for body, name in (("ball", "surface"), ("inner_ring", "raceway"), ("outer_ring", "seat")):
        with pytest.raises(MeshError, match=rf"has no (facet|node) set '{name}'.*\[mesh.sets.{body}\] {name} = ") as why:
            told(body, name)
        assert (why.value.mistake.path, why.value.mistake.value) == (f"mesh.{body}", given)
    with pytest.raises(MeshError, match="has no facet set 'seat'"):
        told("outer_ring", "seat", outer_seat=1e12)
    rings = File(inner_ring=given, outer_ring=given, scale=1e-3, sets={"inner_ring": ring, "outer_ring": ring})
    with pytest.raises(MeshError, match="`mesh.ball`.*required with elastic bodies"):
        check_sets(rings, rings.mesh(BEARING), Supports())


@pytest.fixture(scope="module")
def solids(tmp_path_factory):
    folder = tmp_path_factory.mktemp("solids")
    for name in ("box", "ball"):
        write(folder / f"{name}.step", name)
    return folder


def signal_actions() -> dict[str, str]:
    """Masks of the signals that this process ignores and catches."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return dict(line.split(":\t") for line in lines if line.startswith(("SigIgn", "SigCgt")))


@pytest.mark.needs("gmsh")
def test_signals_are_answered_as_before_a_mesh():
    """A server whose reader has gone is killed where SIGPIPE is the system's again."""
    before = signal_actions()
    assert int(before["SigIgn"], 16) >> (signal.SIGPIPE - 1) & 1
    Gmsh.examples()[0].predict(BEARING)
    assert signal_actions() == before


@pytest.mark.needs("gmsh")
def test_a_step_block_becomes_transfinite_hexahedra_in_metres(solids):
    mesh = Gmsh(inner_ring=str(solids / "box.step"), element_size=2e-3).mesh(BEARING)["inner_ring"]
    assert mesh.volume() == pytest.approx(480e-9, rel=1e-9)
    assert sum(mesh.facet_areas(name).sum() for name in mesh.facet_sets) == pytest.approx(376e-6, rel=1e-9)


@pytest.mark.needs("gmsh")
def test_a_step_ball_needs_subdivision(solids):
    path = str(solids / "ball.step")
    with pytest.raises(
        MeshError, match="cannot be meshed with hexahedra by method = 'transfinite': .* tetrahedra.*'subdivision'"
    ):
        Gmsh(ball=path, element_size=2e-3).mesh(BEARING)
    mesh = Gmsh(ball=path, element_size=1e-3, method="subdivision").mesh(BEARING)["ball_00"]
    # Chords of half the tetrahedra's edge cut off a few percent of the sphere.
    assert mesh.volume() == pytest.approx(4.0 / 3.0 * np.pi * 64e-9, rel=0.05)


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize(
    ("size", "words"),
    [(7e-3, "larger than the smallest extent of 'box.step', 0.006 m"), (1e-6, r"4\.8e\+11 elements and take .* GiB")],
)
def test_sizes_that_gmsh_shall_not_try(solids, size, words):
    with pytest.raises(MeshError, match=words):
        Gmsh(inner_ring=str(solids / "box.step"), element_size=size).mesh(BEARING)
