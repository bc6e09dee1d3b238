"""Sections of rings and balls: where their nodes lie, what a polygon gives, what is refused."""

import attrs
import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import MeshError, SceneError, scene_from_dict
from raceway.core.fem.patches.patch import BallElements, free_ball
from raceway.core.fem.revolution.body import Revolution
from raceway.core.fem.revolution.sections import Profile, coarse_profile, dofs, graded_profile
from raceway.extend import refuse_bad_cells, ring_shape
from raceway.testing import b7206c, ring_inertia
from tests.core.revolution.sections import BEARING, RADIUS, STEEL, ball

Structured = built_in("mesher", "structured")

WINDOW = (np.deg2rad(5.0), np.deg2rad(28.0))
#: Chamfers at every corner of the inner ring; an outer ring with one shoulder only.
INNER = [
    [-8e-3, 16.2e-3], [-6.8e-3, 15e-3], [6.8e-3, 15e-3], [8e-3, 16.2e-3],
    [8e-3, 19.5e-3], [7.4e-3, 20.1e-3], [-7.4e-3, 20.1e-3], [-8e-3, 19.5e-3],
]  # fmt: skip
OUTER = [[-8e-3, 25.9e-3], [1e-3, 25.9e-3], [1.5e-3, 27.2e-3], [8e-3, 27.2e-3], [8e-3, 31e-3], [-8e-3, 31e-3]]


def scene(**bearing):
    return scene_from_dict(b7206c(bearing=bearing))


@pytest.mark.parametrize("inner", [True, False])
def test_race_nodes_lie_on_the_groove_at_their_contact_angles(inner):
    shape = ring_shape(BEARING, inner)
    profile = graded_profile(shape, 0.2e-3, WINDOW, 0.1e-3, 1e-3)
    r, x = profile.points[profile.race].T
    assert r == pytest.approx(shape.centre_r + shape.sign * shape.groove * np.cos(profile.angles), rel=1e-13)
    assert x == pytest.approx(shape.centre_x + shape.sign * shape.groove * np.sin(profile.angles), abs=1e-17)
    assert np.diff(profile.angles) == pytest.approx(0.2e-3 / shape.groove, rel=1e-9)
    assert np.abs(profile.angles - BEARING.contact_angle).min() < 1e-12  # one node at the free contact angle
    assert profile.angles[0] >= WINDOW[0] - 1e-9 and profile.angles[-1] <= WINDOW[1] + 1e-9
    assert profile.points[profile.seat, 0] == pytest.approx(shape.seat, rel=1e-14)
    # Layers below a race node follow it.
    first = profile.points[profile.race[3]] - profile.points[profile.race[3] + 1]
    assert np.linalg.norm(first) <= 0.12e-3


@pytest.mark.parametrize("inner", [True, False])
def test_a_section_holds_the_ring(inner):
    """The groove's chords cut off h^2 of 0.5 mm elements, 3e-4 of the volume."""
    shape = ring_shape(BEARING, inner)
    body = Revolution(coarse_profile(shape), 400, *STEEL)
    assert body.mass == pytest.approx(7810.0 * shape.volume, rel=1e-3)
    assert shape.moments[0] == pytest.approx(shape.volume, rel=1e-12)


def test_a_window_beyond_the_groove_ends_at_its_edge():
    shape = ring_shape(BEARING, False)
    profile = graded_profile(shape, 0.2e-3, (0.0, 2.0), 0.2e-3, 1e-3)
    assert 0.0 < shape.edge - profile.angles[-1] < 1.6 * 0.2e-3 / shape.groove
    for step, window, word in ((0.2e-3, (1.2, 1.4), "outside the groove"), (5e-3, WINDOW, "fewer than two nodes")):
        with pytest.raises(MeshError, match=word):
            graded_profile(shape, step, window, 0.2e-3, 1e-3)


def test_a_folded_section_is_refused():
    points = [[1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0], [1.2, 2.0], [0.5, 0.5]]
    with pytest.raises(MeshError, match="folds over"):
        Profile(points, [[0, 1, 2, 3], [1, 4, 5, 2]], [0], [], [0.0])


def test_one_ball_serves_all_sizes_and_materials(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    offsets = np.array([0, 1, 12])
    small = free_ball(4e-3, 0.29, BallElements(24, 0.2e-3, 0.4e-3, 0.3e-3, 1e-3), offsets)
    large = free_ball(8e-3, 0.29, BallElements(24, 0.4e-3, 0.8e-3, 0.6e-3, 2e-3), offsets)
    assert np.array_equal(small.dimensionless, large.dimensionless)
    assert len(list(tmp_path.rglob("*.arrays"))) == 1
    assert large.compliance(8e-3, 3e11) * 8e-3 * 3e11 == pytest.approx(small.dimensionless, rel=1e-14)
    profile = ball(0.3e-3)
    direct = Revolution(profile, 24, *STEEL, seat="free").compliance(dofs(profile.race), dofs(profile.race), [0], "all")
    one = free_ball(RADIUS, 0.29, BallElements(24, 0.3e-3, 0.6e-3, 0.6e-3, 2e-3), np.array([0]))
    # Sizes over the radius are kept to nine digits, so that equal balls find the same entry.
    assert one.compliance(RADIUS, STEEL[0])[0] == pytest.approx(direct[0], rel=1e-6, abs=1e-8 * np.abs(direct).max())
    assert one.latitudes == pytest.approx(profile.angles, rel=1e-8)


def test_a_polygon_gives_the_ring_to_all_meshers():
    given = scene(inner_profile=INNER, outer_profile=OUTER)
    assert scene_from_dict(given.to_dict()).bearing == given.bearing
    for inner in (True, False):
        shape = ring_shape(given.bearing, inner)
        profile = coarse_profile(shape, 1e-3)
        body = Revolution(profile, 400, *STEEL)
        assert body.mass == pytest.approx(7810.0 * shape.volume, rel=1e-3)
        seat = np.sort(profile.points[profile.seat, 1])
        assert seat[[0, -1]] == pytest.approx([-6.8e-3, 6.8e-3] if inner else [-8e-3, 8e-3])  # not the chamfers
        assert profile.angles[-1] == pytest.approx(-shape.edges[0] if inner else shape.edges[1])
    meshes = Structured(element_size=1e-3, nodes_per_semi_axis=2).mesh(given.bearing)
    for word, inner in (("inner_ring", True), ("outer_ring", False)):
        refuse_bad_cells(meshes[word], word)
        # Chamfers' corners on the seat are met by lines of the mesh, the groove by chords.
        assert meshes[word].volume() == pytest.approx(ring_shape(given.bearing, inner).volume, rel=4e-3)
    plain = ring_inertia(scene().bearing)
    mass, inertia, _ = ring_inertia(given.bearing)
    assert mass == pytest.approx(7810.0 * ring_shape(given.bearing, True).volume, rel=1e-12)
    assert 0.9 * plain[1] < inertia < plain[1]  # chamfers only


def test_a_rectangle_is_the_ring_of_the_catalogue():
    """The same ring, said as a polygon: the same sections and compliances."""
    shape = ring_shape(BEARING, True)
    box = [[-8e-3, 15e-3], [8e-3, 15e-3], [8e-3, shape.land], [-8e-3, shape.land]]
    given = ring_shape(attrs.evolve(BEARING, inner_profile=tuple(map(tuple, box))), True)
    assert given.edges == pytest.approx(shape.edges, rel=1e-12)
    assert given.volume == pytest.approx(shape.volume, rel=1e-12)
    assert (given.groove, given.centre_r) == pytest.approx((shape.groove, shape.centre_r), rel=1e-12)
    assert coarse_profile(given).points == pytest.approx(coarse_profile(shape).points, abs=1e-12)


@pytest.mark.parametrize(("polygon", "word"), [
    ([[0.0, 15e-3], [1e-3, 15e-3], [1e-3, 20e-3]], "at least 4"),
    ([[-8e-3, 15e-3], [8e-3, 15e-3], [9e-3, 17e-3], [8e-3, 20e-3], [-8e-3, 20e-3]], "side face"),
    ([[-8e-3, 15e-3], [2e-3, 15e-3], [2e-3, 16e-3], [8e-3, 16e-3], [8e-3, 20e-3], [-8e-3, 20e-3]], "vertical step"),
    ([[-8e-3, 15e-3], [8e-3, 15e-3], [8e-3, 18e-3], [-8e-3, 18e-3]], "meets the race side 0 times"),
    ([[-2e-3, 15e-3], [2e-3, 15e-3], [2e-3, 20e-3], [-2e-3, 20e-3]], "meets the race side 0 times"),
    ([[-8e-3, 15e-3], [-1e-3, 18.9e-3], [8e-3, 15e-3], [8e-3, 20e-3], [-8e-3, 20e-3]], "no wall is left"),
    ([[-8e-3, 15e-3], [8e-3, 15e-3], [8e-3, 24e-3], [-8e-3, 24e-3]], "closes over the groove"),
    ([[-8e-3, 14e-3], [8e-3, 14e-3], [8e-3, 20e-3], [-8e-3, 20e-3]], "give the same"),
    ([[-8e-3, 15e-3], [8e-3, 15e-3], [8e-3, -20e-3], [-8e-3, 20e-3]], "greater than 0"),
    ([[-8e-3, 15e-3], [0.0, 21e-3], [8e-3, 15e-3], [8e-3, 20e-3], [-8e-3, 20e-3]], "crosses itself"),
    ("round", "list of points"),
])  # fmt: skip
def test_polygons_that_are_no_ring_are_refused_with_the_key(polygon, word):
    with pytest.raises(SceneError, match=word) as found:
        scene(inner_profile=polygon)
    assert "inner" in str(found.value)


def test_the_inner_rings_inertia_is_that_of_its_exact_section():
    """The hollow cylinder less its groove, without a mesh: the same integrals as of the shape that is meshed."""
    found, shape = ring_inertia(scene().bearing), ring_shape(scene().bearing, True)
    assert found == pytest.approx([7810.0 * moment for moment in shape.moments], rel=1e-9)
    # A mesh of hexahedra agrees to its chords and to the cells' own inertia.
    mesh = Structured(element_size=0.5e-3, nodes_per_semi_axis=2).mesh(scene().bearing)["inner_ring"]
    centres, volumes = mesh.points[mesh.cells].mean(axis=1), mesh.cell_volumes()
    polar = float(volumes @ (centres[:, 1] ** 2 + centres[:, 2] ** 2))
    assert shape.moments[2] == pytest.approx(polar, rel=5e-3)
