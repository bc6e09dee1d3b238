"""Where a whole contact presses on a mesh, and which motions of the body it does not feel."""

import attrs
import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.core.fem.elastic.resultant import Footprint, footprint, hertz_weights
from raceway.core.fem.elastic.surface import Facets
from raceway.extend import azimuth, mesh_bodies, resolve, ring_shape
from raceway.testing import b7206c

#: The coarsest meshes in use: a ball of 4 cells across, 36 cells around a ring.
MESH = {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 36}
#: Semi-axes of the ellipse, along the groove and across [m].
WIDE = 1e-3, 2e-3


@attrs.frozen(eq=False)
class Place:
    """A contact: facets, normal into the body, the surface's centre and radius of curvature [m], and its footprint."""

    facets: Facets
    normal: np.ndarray
    centre: np.ndarray
    radius: float
    found: Footprint

    @property
    def arms(self) -> np.ndarray:
        """(k, 3) from the centre to the nodes [m]."""
        return np.asarray(self.facets.points[self.found.nodes] - self.centre)

    def moved(self, u: np.ndarray) -> np.ndarray:
        """(3,) what the contact sees of displacements (k, 3) of its nodes."""
        return np.einsum("akc,kc->a", self.found.share, u)


@pytest.fixture(scope="module")
def bearing():
    scene = scene_from_dict(b7206c(bearing={"ball_count": 3}, bodies={"kind": "elastic"}, mesh=MESH))
    return scene.bearing, mesh_bodies(resolve(scene))


def on(bearing, body: str, angle: float, ball: int = 1) -> Place:
    """A contact of a ball at a contact angle [rad] on the rings or the ball itself."""
    b, meshes = bearing
    psi = azimuth(b, ball)
    axial, radial = np.array([1.0, 0.0, 0.0]), np.array([0.0, np.cos(psi), np.sin(psi)])
    outward = np.sin(angle) * axial + np.cos(angle) * radial
    along = np.cos(angle) * axial - np.sin(angle) * radial
    if body == "ball":
        name, surface = [n for n in meshes if n.startswith("ball")][ball], "surface"
        normal, radius, centre = -outward, 0.5 * b.ball_diameter, 0.5 * b.pitch_diameter * radial
        pole = centre - radius * normal
    else:
        name, surface = body, "raceway"
        shape = ring_shape(b, body == "inner_ring")
        normal, radius = (-outward if shape.inner else outward), shape.groove
        centre = shape.centre_x * axial + shape.centre_r * radial
        pole = centre + radius * normal
    facets = Facets(meshes[name].points, meshes[name].facet_nodes(surface))
    return Place(facets, normal, centre, radius, footprint(facets, pole, normal, along, centre, WIDE))


#: B7206C's own angle of 15 deg, and others that put the ellipse elsewhere on the cells.
CONTACTS = [(body, np.radians(angle)) for body in ("inner_ring", "outer_ring", "ball") for angle in (9.0, 15.0, 22.0)]


@pytest.fixture(params=CONTACTS, ids=lambda value: f"{value[0]}-{np.degrees(value[1]):.0f}")
def place(bearing, request):
    return on(bearing, *request.param)


def test_the_pressure_on_the_ellipse_falls_as_a_parabola():
    a, b = WIDE
    points, weights = hertz_weights(WIDE)
    share = (points / WIDE) ** 2
    # Gauss points integrate polynomials exactly, angles of equal distance the even powers: rounding is left.
    assert weights.sum() == pytest.approx(1.0, rel=1e-14)
    assert (weights > 0.0).all() and share.sum(axis=1).max() < 1.0
    np.testing.assert_allclose(weights @ points, 0.0, atol=1e-16)
    # Means of r^2 and r^4 under 1 - r^2: 1/3 and 1/6; r^2 is of x and y alike.
    np.testing.assert_allclose(weights @ points**2, [a * a / 6.0, b * b / 6.0], rtol=1e-13)
    assert weights @ share.sum(axis=1) == pytest.approx(1.0 / 3.0, rel=1e-13)
    assert weights @ share.sum(axis=1) ** 2 == pytest.approx(1.0 / 6.0, rel=1e-13)


def test_the_normal_force_presses_with_positive_weights_near_the_contact_and_translations_are_seen(place):
    """The rigid fit and the weights know a translation to rounding."""
    found = place.found
    assert found.weights.sum() == pytest.approx(1.0, rel=1e-13)
    np.testing.assert_allclose(found.share.sum(axis=1), np.eye(3), atol=1e-13)
    nodal = np.einsum("akc,a->kc", found.share, place.normal)
    np.testing.assert_allclose(nodal, found.weights[:, None] * place.normal, atol=1e-13)
    assert (found.weights >= 0.0).all() and found.weights.max() > 0.1
    assert len(set(found.nodes.tolist())) == len(found.nodes)
    # The ellipse's points and the circle of its larger semi-axis, and the cells of up to 4.6 mm diagonal that hold them.
    pole = place.centre + place.radius * place.normal * (-1.0 if place.normal @ place.arms.mean(axis=0) < 0.0 else 1.0)
    away = np.linalg.norm(place.facets.points[found.nodes] - pole, axis=1)
    assert away.max() < WIDE[1] + 4.6e-3


def test_turning_about_the_centre_of_curvature_is_not_seen(place):
    for axis in np.eye(3):
        seen = place.moved(np.cross(axis, place.arms)) / place.radius
        along = float(seen @ place.normal)
        # Across the normal the turn is part of the rigid fit: rounding.
        np.testing.assert_allclose(seen - along * place.normal, 0.0, atol=1e-13)
        # Along it the mean place of the force lies beside the normal: facets of 2 to 3 mm on an arc of 5 mm lie up to a
        # sixteenth of its radius below it, by more on one side of the pole than on the other, 1.1e-2 at most.
        assert abs(along) < 1.5e-2


def test_the_force_acts_in_the_centre_of_curvature(place):
    force = np.array([0.3, -1.0, 0.7])
    nodal = np.einsum("akc,a->kc", place.found.share, force)
    np.testing.assert_allclose(nodal.sum(axis=0), force, atol=1e-13)
    moment = np.cross(place.arms, nodal).sum(axis=0) / place.radius
    # The part across has none; the normal part acts at the mean place, as above.
    assert np.abs(moment).max() < 1.5e-2 * abs(force @ place.normal)
    across = force - (force @ place.normal) * place.normal
    nodal = np.einsum("akc,a->kc", place.found.share, across)
    np.testing.assert_allclose(np.cross(place.arms, nodal).sum(axis=0) / place.radius, 0.0, atol=1e-13)


def test_a_wider_ellipse_spreads_the_force(bearing):
    b, _ = bearing
    near = on(bearing, "ball", b.contact_angle)
    radius = near.radius
    pole = near.centre - radius * near.normal
    along = np.cross(near.normal, [0.0, np.cos(azimuth(b, 1) + 0.5 * np.pi), np.sin(azimuth(b, 1) + 0.5 * np.pi)])
    far = footprint(near.facets, pole, near.normal, along, near.centre, (2.2e-3, 2.2e-3))

    def spread(found: Footprint) -> float:
        return float(found.weights @ np.linalg.norm(near.facets.points[found.nodes] - pole, axis=1) ** 2)

    assert spread(far) > 1.1 * spread(near.found)


def test_a_contact_that_wanders_over_the_cells_presses_where_it_is(bearing):
    places = []
    for angle in np.radians(np.arange(-5.0, 40.0, 0.5)):
        place = on(bearing, "ball", angle, ball=0)
        places.append(place.found.weights @ place.arms / place.radius)
    # Half a degree moves the mean place by 9e-3 of the radius; facets bring it on by twice that at most.
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < 2e-2
