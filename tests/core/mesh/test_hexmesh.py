"""HexMesh and its quality on blocks whose answers are known."""

import attrs
import numpy as np
import pytest
from raceway_view.mesh_summary import summary

from checks.validation.cubes import block
from checks.validation.solids import facet_normals
from raceway import MeshError
from raceway.extend import HexMesh, cell_quality, merged, refuse_bad_cells

#: Sums of a few hundred terms in double precision.
ROUNDING = 1e-12


def test_volume_area_and_normals_of_a_block():
    mesh = block()
    assert mesh.volume() == pytest.approx(6.0, rel=ROUNDING)
    shear = np.array([[1.0, 0.0, 0.3], [0.2, 1.0, 0.06], [0.0, 0.0, 1.0]])  # x += 0.3 z, y += 0.2 x
    assert attrs.evolve(mesh, points=mesh.points @ shear.T).volume() == pytest.approx(6.0, rel=ROUNDING)
    areas, normals = mesh.facet_areas("outside"), facet_normals(mesh, "outside")
    assert areas.sum() == pytest.approx(22.0, rel=ROUNDING)
    # Closed surface: area vectors cancel, and they point outward, so that their flux of x is three volumes.
    assert np.abs((areas[:, None] * normals).sum(axis=0)).max() < 1e-12
    centres = mesh.points[mesh.facet_nodes("outside")].mean(axis=1)
    assert (areas * (normals * centres).sum(axis=1)).sum() == pytest.approx(18.0, rel=ROUNDING)


def test_areas_of_facets_that_are_no_parallelograms():
    """A cube whose side x grows with y: trapezoids of area (1 + 1.5) / 2 at both ends along z, where Gauss' rule is exact."""
    mesh = block(1, 1, 1, (1.0, 1.0, 1.0))
    x, y, z = mesh.points.T
    mesh = attrs.evolve(mesh, points=np.column_stack([x * (1.0 + 0.5 * y), y, z]))
    flat = np.ptp(mesh.points[mesh.facet_nodes("outside")][:, :, 2], axis=1) == 0.0
    assert flat.sum() == 2
    assert mesh.facet_areas("outside")[flat] == pytest.approx(1.25, rel=ROUNDING)
    slanted = np.hypot(1.0, 0.5)
    assert mesh.facet_areas("outside").sum() == pytest.approx(2.0 * 1.25 + 1.0 + 1.5 + 1.0 + slanted, rel=ROUNDING)


def test_sizes_of_the_cells_below_a_patch():
    """Facets of 1/2 by 3/4 on top of cells that are 2 deep."""
    mesh = block(2, 4, 1, (1.0, 3.0, 2.0))
    outside = mesh.facets("outside")
    top = (mesh.points[mesh.facet_nodes("outside")][:, :, 2] == 2.0).all(axis=1)
    found = summary({"body": attrs.evolve(mesh, facet_sets={"band": outside[top]})})["patch_size_m"]
    for word, size in (("short", 0.5), ("long", 0.75), ("depth", 2.0)):
        assert found[word] == pytest.approx({"min": size, "max": size}, rel=ROUNDING)


def test_volume_of_a_distorted_cell_is_that_of_its_faces():
    rng = np.random.default_rng(4)
    mesh = block(1, 1, 1, (1.0, 1.0, 1.0))
    mesh = attrs.evolve(mesh, points=mesh.points + 0.2 * rng.uniform(-1, 1, mesh.points.shape))
    # Divergence theorem on the bilinear faces, with many points of the midpoint rule: error about 1 / (6 n^2).
    n, flux = 200, 0.0
    s = (np.arange(n) + 0.5) / n
    for a, b, c, d in mesh.points[mesh.facet_nodes("outside")]:
        u, v = (t[..., None] for t in np.meshgrid(s, s))
        place = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
        along, across = (1 - v) * (b - a) + v * (c - d), (1 - u) * (d - a) + u * (c - b)
        flux += (place * np.cross(along, across)).sum() / n**2 / 3.0
    assert mesh.volume() == pytest.approx(flux, rel=1e-4)


def test_quality_of_a_cuboid_and_of_a_shear():
    found = cell_quality(block(2, 2, 2, (1.0, 2.0, 4.0)))
    assert found.scaled_jacobian == pytest.approx(1.0, abs=ROUNDING)
    assert found.aspect == pytest.approx(4.0, rel=ROUNDING)
    assert found.skew == pytest.approx(0.0, abs=ROUNDING)
    cube = block(1, 1, 1, (1.0, 1.0, 1.0))
    slanted = attrs.evolve(cube, points=cube.points @ np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]]))
    # The third edge leans by 45 degrees: determinant 1, lengths 1, 1 and sqrt 2.
    found = cell_quality(slanted)
    assert found.scaled_jacobian == pytest.approx(np.sqrt(0.5), rel=ROUNDING)
    assert found.skew == pytest.approx(np.sqrt(0.5), rel=ROUNDING)


def test_inverted_cells_are_counted_and_the_first_is_located():
    mesh = block()
    cells = mesh.cells.copy()
    cells[[7, 11]] = cells[[7, 11]][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    with pytest.raises(MeshError, match=r"`ring`: 2 of 60 cells .* cell 7, inverted .* centre \(.*\) m, nodes \d+") as told:
        refuse_bad_cells(attrs.evolve(mesh, cells=cells), "ring")
    assert ", ".join(str(n) for n in cells[7]) in str(told.value)


@pytest.mark.parametrize("squeeze", [0.0, 1e-9])
def test_degenerate_cells_are_refused(squeeze):
    mesh = block(1, 1, 2)
    points = mesh.points.copy()
    points[points[:, 2] == 3.0, 2] = 1.5 + squeeze * points[points[:, 2] == 3.0, 0]
    points[mesh.cells[1, 4]] = points[mesh.cells[1, 0]]
    with pytest.raises(MeshError, match="1 of 2 cells .* cell 1, degenerate"):
        refuse_bad_cells(attrs.evolve(mesh, points=points))


def test_missing_and_empty_sets_are_named_with_the_nearest():
    mesh = attrs.evolve(block(), facet_sets={"raceway": [[0, 0]], "seat": []})
    with pytest.raises(MeshError, match=r"no facet set 'racway' \(did you mean 'raceway'\?\); it has raceway, seat"):
        mesh.facets("racway")
    with pytest.raises(MeshError, match="facet set 'seat' is empty; sets that are not: raceway"):
        mesh.facet_areas("seat")
    with pytest.raises(MeshError, match="no node set 'raceway'.*it has corner"):
        mesh.nodes("raceway")


@pytest.mark.parametrize(("change", "words"), [
    ({"points": [[0.0, 0.0]]}, r"must be \(n, 3\)"), ({"cells": [[0, 1, 2, 3]]}, r"must be \(m, 8\)"),
    ({"cells": [[0, 1, 2, 3, 4, 5, 6, 999]]}, "a point that does not exist"),
    ({"points": np.full((200, 3), np.nan)}, "not a finite number"), ({"node_sets": {"far": [500]}}, "node set 'far'"),
    ({"facet_sets": {"far": [[500, 0]]}}, "facet set 'far'"),
])  # fmt: skip
def test_arrays_that_are_no_mesh_are_refused(change, words):
    with pytest.raises(MeshError, match=words):
        attrs.evolve(block(), **change)


def test_merging_keeps_bodies_apart_and_prefixes_their_sets():
    one, two = block(), block(2, 2, 2)
    both = merged({"a": one, "b": two})
    assert both.volume() == pytest.approx(one.volume() + two.volume(), rel=ROUNDING)
    assert both.facet_areas("b.outside").sum() == pytest.approx(two.facet_areas("outside").sum(), rel=ROUNDING)
    assert set(both.node_sets) == {"a", "b", "a.corner", "b.corner"}
    assert both.nodes("b.corner")[0] == len(one.points)
    with pytest.raises(MeshError, match="no mesh"):
        merged({})


def test_renumbering_a_shuffled_mesh_restores_locality_and_changes_nothing_else():
    mesh = block(12, 12, 12)
    rng = np.random.default_rng(1)
    place, order = rng.permutation(len(mesh.points)), rng.permutation(len(mesh.cells))
    points = np.empty_like(mesh.points)
    points[place] = mesh.points
    where = np.argsort(order)
    facets = np.column_stack([where[mesh.facets("outside")[:, 0]], mesh.facets("outside")[:, 1]])
    mixed = HexMesh(points, place[mesh.cells][order], {"corner": place[[0]]}, {"outside": facets})
    tidy = mixed.renumbered()
    # The levels of Cuthill-McKee from a corner of a cube are its diagonal planes, up to twice as large as its layers.
    distance = {name: np.ptp(one.cells, axis=1).mean() for name, one in (("own", mesh), ("mixed", mixed), ("tidy", tidy))}
    assert distance["tidy"] < 2.0 * distance["own"] < 0.5 * distance["mixed"]
    assert np.ptp(mesh.renumbered().cells, axis=1).mean() == distance["own"]
    assert tidy.volume() == pytest.approx(mesh.volume(), rel=ROUNDING)
    assert tidy.facet_areas("outside").sum() == pytest.approx(22.0, rel=ROUNDING)
    assert np.array_equal(tidy.points[tidy.nodes("corner")], mesh.points[[0]])
    assert (np.diff(tidy.cells.min(axis=1)) >= 0).all()
