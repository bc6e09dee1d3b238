"""Structured bearings against the exact solids: rates, contacts, sizes, and what is refused."""

from math import pi

import attrs
import numpy as np
import pytest
from raceway_view.mesh_summary import summary

from checks.validation.command_line import EXAMPLES
from checks.validation.quarter import quarter_groove
from checks.validation.scenes import built_in
from checks.validation.solids import facet_normals
from raceway import MeshError, SceneError, load_scene, scene_from_dict
from raceway.core.fem.mesh import part_meshes as sphere
from raceway.core.fem.mesh.part_meshes import ball_cells, ball_mesh, ring_mesh
from raceway.extend import EDGES, cell_quality, graded, growing, mesh_bodies, refuse_bad_cells, resolve, ring_shape
from raceway.plugins.bodies.mesh import mesher_of

Structured = built_in("mesher", "structured")

BEARING = load_scene(EXAMPLES / "minimal.toml").bearing
COARSE = Structured(element_size=1.5e-3, nodes_per_semi_axis=2, growth=1.6)


def halved(points):
    """The same points with one in the middle of each two: a refinement by exactly 2."""
    return np.sort(np.concatenate([points, 0.5 * (points[1:] + points[:-1])]))


def test_spacings_reach_their_ends_and_keep_their_limits():
    line = graded(-1.0, 1.0, -0.1, 0.2, 0.02, 0.15, 1.3)
    steps = np.diff(line)
    assert line[0] == -1.0 and line[-1] == 1.0 and (steps > 0).all()
    assert steps.max() <= 0.15 * (1 + 1e-12)
    inside = (line[:-1] > -0.1 - 1e-12) & (line[1:] < 0.2 + 1e-12)
    assert steps[inside].max() <= 0.02 * (1 + 1e-12)
    assert (steps[1:] / steps[:-1]).max() < 1.3 * (1 + 1e-9)
    assert np.diff(growing(1.0, 0.3, 0.2, 1.3)) == pytest.approx(0.2)


def rings(inner):
    """Volume and area of meshes, each of half the size of the one before, and those of the solid of revolution."""
    shape = ring_shape(BEARING, inner)
    *lines, band = COARSE._ring_lines(BEARING, shape)
    found = []
    for divisions in (24, 48, 96):
        mesh = ring_mesh(shape, *lines, np.linspace(0.0, 2.0 * pi, divisions, endpoint=False), band=band)
        found.append((mesh.volume(), mesh.facet_areas("raceway").sum()))
        lines = [halved(line) for line in lines]
    low, high = shape.edges
    radius = shape.centre_r + shape.sign * shape.groove * (np.sin(high) - np.sin(low)) / (high - low)  # of its centroid
    return found, (shape.volume, 2.0 * pi * radius * shape.groove * (high - low))


def balls():
    radius = 0.5 * BEARING.ball_diameter
    *lines, patch = COARSE._ball_lines(BEARING)
    found = []
    for _ in range(3):
        mesh = ball_mesh(radius, *lines, patch)
        assert len(mesh.cells) == ball_cells(*(len(line) - 1 for line in lines))
        found.append((mesh.volume(), mesh.facet_areas("surface").sum()))
        lines = [halved(line) for line in lines]
    return found, (4.0 / 3.0 * pi * radius**3, 4.0 * pi * radius**2)


@pytest.mark.parametrize(
    "solids", [lambda: rings(True), lambda: rings(False), balls], ids=["inner ring", "outer ring", "ball"]
)
def test_a_body_converges_at_order_2_to_its_solid(solids):
    """Facets of curved surfaces: the error is a series in h^2, so that the rate of fine meshes is 2 to a few 0.01."""
    found, exact = solids()
    _, coarse, fine = np.abs(np.divide(found, exact) - 1.0)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.05)


def test_a_cube_with_all_of_the_bulge_is_a_sphere(monkeypatch):
    """The smooth map of cube to ball takes the cube's faces to the unit sphere: to rounding."""
    line = np.linspace(-1.0, 1.0, 7)
    faces = np.stack(np.meshgrid(line, line, [-1.0, 1.0]), axis=-1).reshape(-1, 3)
    monkeypatch.setattr(sphere, "BULGE", 1.0)
    for turn in range(3):
        assert np.linalg.norm(sphere._rounded(np.roll(faces, turn, axis=1)), axis=1) == pytest.approx(1.0, rel=1e-14)
    monkeypatch.setattr(sphere, "BULGE", 0.0)
    assert sphere._rounded(faces) == pytest.approx(faces, rel=1e-14)


def test_a_quarter_groove_is_a_torus_that_touches_the_ball():
    """Nodes lie on the groove to rounding; the one at its bottom is the ball's lowest point."""
    ball, groove, rolling = 4.76e-3, 4.97e-3, 18.4e-3
    lines = np.linspace(0.0, 0.3, 7), np.linspace(0.0, 0.1, 5), np.array([0.0, 1e-3, 3e-3])
    mesh = quarter_groove(ball, groove, rolling, *lines)
    x, y, z = mesh.points[mesh.nodes("raceway")].T
    about = np.hypot(y, z + ball + rolling)
    assert np.hypot(x, about - (rolling + groove)) == pytest.approx(groove, rel=1e-12)
    distance = np.linalg.norm(mesh.points, axis=1)
    assert mesh.points[distance.argmin()] == pytest.approx([0.0, 0.0, -ball], abs=1e-12 * ball)


def test_the_bearing_is_whole_good_and_predicted():
    meshes = COARSE.mesh(BEARING)
    assert list(meshes) == ["inner_ring", "outer_ring", *(f"ball_{i:02d}" for i in range(12))]
    assert sum(len(mesh.cells) for mesh in meshes.values()) == COARSE.predict(BEARING).cells
    for name, mesh in meshes.items():
        assert refuse_bad_cells(mesh, name).scaled_jacobian.min() > 0.2
        edges = np.linalg.norm(np.diff(mesh.points[mesh.cells[:, EDGES]], axis=2)[:, :, 0], axis=2)
        assert edges.max() <= COARSE.element_size * (1 + 1e-9)
        assert all(len(s) for s in (*mesh.node_sets.values(), *mesh.facet_sets.values()))


@pytest.mark.parametrize("arrangement", ["single", "DB"])
def test_balls_touch_their_grooves_where_the_geometry_says(arrangement):
    bearing = attrs.evolve(BEARING, arrangement=arrangement, first_ball_azimuth_deg=10.0)
    meshes = COARSE.mesh(bearing)
    for row, (side, place) in enumerate(bearing.rows):
        suffix = f"_row{row + 1}" if arrangement == "DB" else ""
        ball = meshes["ball_03" + suffix]
        radial = np.array([np.cos(np.radians(100.0)), np.sin(np.radians(100.0))])
        normal = np.r_[side * np.sin(bearing.contact_angle), np.cos(bearing.contact_angle) * radial]
        centre = np.r_[place, 0.5 * bearing.pitch_diameter * radial]
        for word, sense in (("outer", 1.0), ("inner", -1.0)):
            contact = centre + sense * 0.5 * bearing.ball_diameter * normal
            patch = ball.points[ball.nodes(f"{word}_patch")]
            # A node of the ball lies at the contact itself, and one of the raceway's band too: both are graded about it.
            assert np.linalg.norm(patch - contact, axis=1).min() < 1e-9
            ring = meshes[f"{word}_ring" + suffix]
            band = ring.points[ring.nodes("band")]
            assert np.linalg.norm(band - contact, axis=1).min() < 1e-9


def test_nodes_of_the_groove_bore_and_sides_lie_on_them():
    shape = ring_shape(BEARING, True)
    mesh = COARSE.mesh(BEARING)["inner_ring"]
    groove, bore = mesh.points[mesh.nodes("raceway")], mesh.points[mesh.nodes("seat")]
    radius = np.hypot(groove[:, 1], groove[:, 2])
    assert np.hypot(groove[:, 0] - shape.centre_x, radius - shape.centre_r) == pytest.approx(shape.groove, rel=1e-12)
    assert np.hypot(bore[:, 1], bore[:, 2]) == pytest.approx(0.5 * BEARING.bore, rel=1e-12)
    assert mesh.points[mesh.nodes("face_positive"), 0] == pytest.approx(0.5 * BEARING.width)
    assert facet_normals(mesh, "raceway")[:, 1:].shape[1] == 2
    outward = (facet_normals(mesh, "seat")[:, 1:] * mesh.points[mesh.facet_nodes("seat")].mean(axis=1)[:, 1:]).sum(axis=1)
    assert (outward < 0.0).all()


@pytest.mark.slow
def test_the_articles_mesh_has_its_size_and_is_good():
    scene = load_scene(EXAMPLES / "b7206_article_mesh.toml")
    assert scene_from_dict(scene.to_dict()).mesh == scene.mesh
    meshes = mesh_bodies(resolve(scene))
    found = summary({name: meshes[name] for name in ("inner_ring", "outer_ring", "ball_00")})
    cells = sum(len(mesh.cells) for mesh in meshes.values())
    assert abs(cells / 1_061_016 - 1.0) < 0.001
    assert found["scaled_jacobian"]["min"] > 0.2
    assert found["element_size_m"]["max"] <= 0.5e-3
    assert found["patch_size_m"]["short"]["min"] < 0.1 * found["element_size_m"]["max"]


def test_the_ball_load_comes_from_the_scene():
    tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "mesh": {"kind": "structured"}}
    # 1000 N on 12 balls at 15 to 19 degrees: 256 to 322 N.
    assert 250.0 < mesher_of(resolve(scene_from_dict(tables))).ball_load < 330.0
    with pytest.raises(SceneError, match="`mesh`"):
        mesh_bodies(resolve(scene_from_dict({"bearing": {"preset": "B7206C"}})))


@pytest.mark.parametrize(("mesher", "change", "words"), [
    ({"element_size": 5e-3}, {}, r"`mesh.element_size` = 0.005: is larger than the wall of the inner ring .*, 0.0032\d* m"),
    ({"element_size": 1e-5}, {}, r"`mesh.element_size` = 1e-05: would give about .*e\+10 elements and take .* GiB"),
    ({"element_size": 2e-4, "azimuth_cells": 100_000}, {}, "elements and take .* GiB, above 4 GiB"),
    ({}, {"bore": None}, "`bearing.bore`: is missing"), ({}, {"width": 6e-3}, "width of 6 mm does not hold the groove"),
    ({}, {"shoulder_height": 1e-4}, "contact angle of 15 deg lies outside the groove"),
])  # fmt: skip
def test_what_cannot_be_meshed_is_refused_with_numbers(mesher, change, words):
    with pytest.raises(MeshError, match=words):
        Structured(**mesher).mesh(attrs.evolve(BEARING, **change))


def test_other_bearings_of_the_catalogue():
    known, unknown = (scene_from_dict({"bearing": {"preset": name}}).bearing for name in ("7206A", "DGB7-MASTA"))
    for mesh in COARSE.mesh(known).values():
        assert cell_quality(mesh).scaled_jacobian.min() > 0.2
    with pytest.raises(MeshError, match="is missing"):
        COARSE.mesh(unknown)
