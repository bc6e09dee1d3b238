"""Stresses below contacts at points: a ball on a groove against Hertz, a bearing's table, its picture and its file."""

from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from checks.validation.cubes import block
from raceway import scene_from_dict
from raceway.core.fem.elastic.stress import contact_axes
from raceway.core.fem.elastic.surface import Facets
from raceway.extend import BelowContact, below_contacts, cells_near, write_whole
from raceway.testing import run
from tests.core.test_elastic_scene import TINY
from tests.core.validation.below_groove import below

TINY = {**TINY, "load": {"axial": 2500.0, "radial": [300.0, 0.0]}}


@pytest.fixture(scope="module")
def result():
    return run(scene_from_dict(TINY))


def test_a_ball_on_a_groove_has_hertz_s_largest_shear():
    """3800 elements, 2.7 down to Hertz's depth: the size to 5 %, the depth of the flat maximum to 15 %."""
    for side in below(2000.0, 4.0, "incompatible", growth=1.4, coarse=4e-3):
        assert side.shear == pytest.approx(side.hertz_shear, rel=0.05)
        assert side.depth == pytest.approx(side.hertz_depth, rel=0.15)
        assert 2.0 < side.cells < 3.0


def test_the_normal_starts_on_both_surfaces_and_goes_into_both_bodies(result):
    bearing = result.model.bearing.bearing
    contact, setup = bearing.system.contact, bearing.setup
    diameter = setup.geometry.ball_diameter
    for pair in range(6):
        ball = pair % 3
        centre = 0.5 * setup.geometry.pitch_diameter * setup.radial(ball)
        of_ball, of_ring = contact_axes(contact, pair, centre, setup.turn(ball)[:, 2])
        assert np.linalg.norm(of_ball.pole - centre) == pytest.approx(0.5 * diameter, rel=1e-12)
        assert np.linalg.norm(of_ring.pole - of_ball.pole) < 0.05 * diameter  # the gap, and chords of millimetres
        for axis in (of_ball, of_ring):
            assert axis.axes @ axis.axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert of_ball.axes[2] @ (centre - of_ball.pole) > 0.0
        assert of_ring.axes[2] == pytest.approx(-of_ball.axes[2], abs=1e-12)
        # The force on the ball points along its normal; points a millimetre apart turn the resultant's direction by degrees.
        force = contact.resultants()[pair]
        assert of_ball.axes[2] @ force / np.linalg.norm(force) > np.cos(np.radians(5.0))


def test_the_ring_s_pole_has_moved_as_the_points_have():
    """Points of a ball that touched a plane of facets and moved along it by 3 mm, on an undeformed plane 1 mm lower."""
    plane = np.array([[x, y, -1.0] for x in range(10) for y in range(10)], dtype=float)
    quads = np.array([[10 * x + y, 10 * x + 10 + y, 10 * x + 11 + y, 10 * x + y + 1] for x in range(9) for y in range(9)])
    place = np.array([[3.6, 4.3, 0.1], [2.6, 4.3, 0.1], [3.1, 4.8, 0.1], [3.1, 3.8, 0.1]])
    pairs, ones = [SimpleNamespace(facets=Facets(plane, quads))], np.ones(4)
    contact = SimpleNamespace(
        pair=np.zeros(4, dtype=int), area=ones, pressure=ones, place=place, projected=place + [3.0, 0.0, -1.1], pairs=pairs
    )
    of_ball, of_ring = contact_axes(contact, 0, np.array([3.1, 4.3, 5.0]), np.array([0.0, 1.0, 0.0]))
    assert of_ball.pole[:2] == pytest.approx([3.1, 4.3], abs=1e-12)
    assert of_ring.pole == pytest.approx([6.1, 4.3, -1.0], abs=1e-12)


def test_the_table_names_the_most_loaded_contact_of_each_race(result):
    found = result.to_dict()
    table, balls = found["model"]["subsurface"], found["equilibrium"]["balls"]
    assert [(one["race"], one["body"]) for one in table] == [
        ("inner", "ball"), ("inner", "ring"), ("outer", "ball"), ("outer", "ring"),
    ]  # fmt: skip
    for one in table:
        loads = [ball[f"load_{one['race']}_n"] for ball in balls]
        assert one["load_n"] == max(loads) == loads[one["ball"]]
        ball = balls[one["ball"]]
        # Steel: of ellipses of any length 0.30 to 0.33 p0 at 0.48 to 0.79 b; of a bearing's long ones near the line's depth.
        assert 0.30 < one["hertz_largest_shear_pa"] / ball[f"peak_pressure_{one['race']}_pa"] < 0.33
        assert 0.70 < one["hertz_depth_m"] / ball[f"semi_minor_{one['race']}_m"] < 0.79
        assert one["resolved"] is False and one["cells_to_hertz_depth"] < 1.0
        assert one["cells_per_semi_major"] > one["cells_per_semi_minor"]  # the ellipse is longer than the elements


def test_the_line_ends_below_hertz_s_depth(result):
    for side in below_contacts(result.model.bearing, result.model, result.equilibrium):
        assert side.profile.depth[0] == 0.0 and side.profile.depth[-1] > 2.0 * side.hertz[1]
    last = attrs.evolve(result.equilibrium, contact_force=np.tile([1.0, 1.0, 2.0], 2))
    bodies = [side.index for side in below_contacts(result.model.bearing, result.model, last)]
    assert bodies == [4, 0, 4, 1]  # of rings and balls: the third ball and each ring


def test_a_race_that_carries_nothing_is_absent(result):
    bodies, contact = result.model.bearing, result.model.bearing.bearing.system.contact
    nothing = attrs.evolve(result.equilibrium, contact_force=np.r_[np.zeros(3), np.ones(3)])
    assert {one.race for one in below_contacts(bodies, result.model, nothing)} == {"outer"}
    pressed, contact.pressure = contact.pressure, 0.0 * contact.pressure
    try:
        assert contact_axes(contact, 0, np.zeros(3), np.array([0.0, 0.0, 1.0])) is None
    finally:
        contact.pressure = pressed


def test_the_screen_tells_shear_where_the_mesh_resolves_it_and_hertz_s_number_elsewhere(result):
    from raceway.pipeline.run_parts import bodies_rows

    ball, ring = result.to_dict()["model"]["subsurface"][:2]
    fine, numbers = (
        {**ball, "resolved": True},
        {one["body"]: f"{1e-6 * one['largest_shear_pa']:.0f}" for one in (ball, ring)},
    )
    for sides, shown, words in (
        ([ball, ring], "not resolved", f"Hertz {1e-6 * ball['hertz_largest_shear_pa']:.0f} MPa"),
        ([fine, ring], f"{numbers['ball']} MPa", "not resolved in ring"),
        ([fine, {**ring, "resolved": True}], f"{numbers['ball']}, {numbers['ring']} MPa", "ball, ring, "),
    ):
        _, (_, value, told) = bodies_rows({"subsurface": sides})
        assert value == shown and words in told


def test_cells_near_a_place_have_a_node_there():
    mesh = block(4, 3, 2, (4.0, 3.0, 2.0))
    points, cells = mesh.points, mesh.cells
    near = cells_near(points, cells, np.array([0.1, 0.1, 0.1]), 0.5)
    assert near.tolist() == [i for i, cell in enumerate(cells) if (np.linalg.norm(points[cell] - 0.1, axis=1) < 0.5).any()]


@pytest.mark.needs("pyvista")
def test_the_picture_and_the_file_of_the_elements_near_the_contacts(result, tmp_path):
    import pyvista
    from raceway_view.stress import StressFields, contact_stress_files

    files = contact_stress_files(result)
    assert list(files) == ["contact.vtu", "stress_contact.png"]
    assert files["stress_contact.png"].startswith(b"\x89PNG")
    grid, whole = pyvista.read(write_whole(files["contact.vtu"], tmp_path / "contact.vtu")), StressFields.of(result)
    most = {2 + one["ball"] for one in result.to_dict()["model"]["subsurface"]}
    assert set(np.unique(grid.cell_data["body"])) == {0, 1} | most
    assert 0 < grid.n_cells < len(whole.cells)
    # The same elements have the same stresses as in fields.vtu.
    middle = {tuple(np.round(1e9 * one).astype(int)): k for k, one in enumerate(whole.points[whole.cells].mean(axis=1))}
    chosen = [middle[tuple(np.round(1e9 * one).astype(int))] for one in grid.points[grid.cells_dict[12]].mean(axis=1)]
    assert np.array_equal(grid.cell_data["largest shear stress [Pa]"], whole.largest_shear[chosen])


@pytest.mark.parametrize(
    ("cells", "resolved"), [((4.0, 9.0, 5.0), True), ((3.9, 9.0, 5.0), False), ((9.0, 9.0, 3.9), False)]
)
def test_stresses_are_resolved_where_the_mesh_is_fine_in_every_direction(cells, resolved, monkeypatch):
    monkeypatch.setattr(BelowContact, "cells", cells)
    assert BelowContact.resolved.fget(BelowContact.__new__(BelowContact)) is resolved
