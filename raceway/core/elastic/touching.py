"""The contacts of a ball bearing: points of the balls' surfaces on the grooves, or a contact resultant for each ball and race."""

from __future__ import annotations

import numpy as np

from raceway.core.contact.sphere import ball_compliance
from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.bearing_data import BearingData
from raceway.core.elastic.contacts.facets import Facets
from raceway.core.elastic.contacts.footprint import Footprint, footprint
from raceway.core.elastic.contacts.friction import CoulombFriction
from raceway.core.elastic.contacts.gap import groove
from raceway.core.elastic.contacts.nodal import NodalContact, Pair
from raceway.core.elastic.contacts.penalty import penalty_stiffness
from raceway.core.elastic.contacts.resultant import ResultantContact, Touch
from raceway.core.elastic.contacts.separation import LoadedBody
from raceway.core.elastic.contacts.surface import SurfacePoints, surface_points
from raceway.core.mesh.hex_mesh import HexMesh

#: Points of a ball count as contact points where the undeformed gap is below this many Hertz approaches at four times the
#: reference load: the ellipse may then move along the groove by twice its own length.
REACH = 5.0
#: Or at this peak pressure [Pa], where that is more: half the load that ISO 76 (4200 MPa) calls a ball bearing's static limit.
#: So bodies are reduced to the same nodes for all loads that bearings run at.
_STATIC = 4.2e9 * 0.5 ** (1.0 / 3.0)
#: Largest reach of a ring over the ball's diameter; semi-axes of the ellipse that a whole contact presses on, along the groove and
#: across it, over the reach of a ring and over the radius of a ball.
_REACH, _ON_RING, _ON_BALL = 0.34, (0.3, 0.6), (0.5, 0.5)
#: Largest overlap of undeformed bodies over the ball's diameter: tens of times what a contact bears.
_OVERLAP = 0.01
#: Distance of nodes over the ball's diameter at which two balls are the same mesh.
_SAME = 1e-9


def nodal_contact(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> NodalContact:
    """Pressures at points; ``meshes``: inner ring, outer ring, balls."""
    s, g, pairs = setup, setup.geometry, []
    for race, word in enumerate(("inner", "outer")):
        surface = _groove(s, race)
        facets = Facets(meshes[race].points, meshes[race].facet_nodes("raceway"))
        ellipse = g.ellipses(s.modulus)[race]
        often = (_STATIC / float(ellipse.peak_pressure(1.0))) ** 3  # the pressure grows with the load's cube root
        reach = REACH * float(ellipse.approach(max(4.0 * s.reference_load, often)))
        for k, ball in enumerate(meshes[2:]):
            middle = 0.5 * g.pitch_diameter * s.radial(k)
            found = surface_points(ball.points, ball.facet_nodes("surface"), middle)
            side = (found.place - middle) @ s.line(k, g.contact_angle)
            found = _near(found, (side < 0.0) == (race == 0), surface, reach)
            found = SurfacePoints(found.place, found.area, found.nodes + assembly.starts[k + 2], found.weights)
            pairs.append(Pair(f"ball {k}, {word} race", found, surface, facets, int(assembly.starts[race])))
    which = np.repeat(np.arange(len(pairs)), [len(p.points.area) for p in pairs])
    area = np.concatenate([p.points.area for p in pairs])
    damping = 0.0
    if s.contact_damping > 0.0:
        a, b = g.ellipses(s.modulus)[0].semi_axes(s.reference_load)
        damping = s.contact_damping / (np.pi * float(a) * float(b))
    friction = CoulombFriction(s.friction, sticking(s, area)) if s.friction > 0.0 else None
    return NodalContact(pairs, assembly.nodes, s.law, s.params(which, area), s.state_size, damping, friction)


def resultant_contact(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> ResultantContact:
    """A force for each ball and race, at the contact angles of ``setup``; ``meshes``: inner ring, outer ring, balls."""
    s, g = setup, setup.geometry
    assert s.angles is not None
    balls = [Facets(ball.points, ball.facet_nodes("surface")) for ball in meshes[2:]]
    loaded = _loaded_balls(s, meshes, assembly)
    beyond = np.zeros(2 * s.ball_count) if s.beyond is None else s.beyond
    touches = []
    for race, word in enumerate(("inner", "outer")):
        conformity = g.conformity_inner if race == 0 else g.conformity_outer
        surface = _groove(s, race)
        surface[5] -= 0.5 * g.ball_diameter
        facets = Facets(meshes[race].points, meshes[race].facet_nodes("raceway"))
        seat = float(np.hypot(*meshes[race].points[meshes[race].nodes("seat"), 1:].T).mean())
        ring = _loaded(assembly, race, s.rings)
        semi_axes = (float(x) for x in g.ellipses(s.modulus)[race].semi_axes(s.reference_load))
        sphere = ball_compliance(0.5 * g.ball_diameter, *s.balls[:2], *semi_axes)[0]
        for k in range(s.ball_count):
            angle = float(s.angles[race * s.ball_count + k])
            # From the ball into the ring, and along the groove.
            normal, along = s.line(k, angle) * (1.0 if race else -1.0), s.line(k, angle + 0.5 * np.pi)
            centre = s.offsets[race][0] * np.array([1.0, 0.0, 0.0]) + s.offsets[race][1] * s.radial(k)
            pole = centre + conformity * g.ball_diameter * normal
            reach = min(abs(float(np.hypot(*pole[1:])) - seat), _REACH * g.ball_diameter)
            wide = _ON_RING[0] * reach, _ON_RING[1] * reach
            on_ring = footprint(facets, pole, normal, along, centre, wide)
            below = ring.separated(on_ring, pole, normal, wide, reach)
            radius, middle = 0.5 * g.ball_diameter, 0.5 * g.pitch_diameter * s.radial(k)
            wide = _ON_BALL[0] * radius, _ON_BALL[1] * radius
            on_ball = footprint(balls[k], middle + radius * normal, -normal, along, middle, wide)
            # Balls that are the same mesh know each other's answers.
            turned = s.turn(k) @ s.turn(loaded[k][0]).T
            above = loaded[k][1].replaced(on_ball, turned.T @ -normal, sphere)
            name, place = f"ball {k}, {word} race", int(assembly.starts[k + 2])
            touches.append(
                Touch(
                    name,
                    _moved(on_ball, place),
                    _moved(on_ring, int(assembly.starts[race])),
                    middle,
                    surface,
                    below.local + above - beyond[race * s.ball_count + k],
                    below.spread,
                    min(float(facets.short.mean()), _OVERLAP * g.ball_diameter),
                )  # fmt: skip
            )
    params = s.params(np.arange(len(touches)), np.ones(len(touches)))
    return ResultantContact(touches, assembly.nodes, s.law, params, s.state_size, s.contact_damping)


def _loaded_balls(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> list[tuple[int, LoadedBody]]:
    """For each ball the first one with the same mesh, turned about the bearing's axis, and that one's answers."""
    out: list[tuple[int, LoadedBody]] = []
    for k, ball in enumerate(meshes[2:]):
        for first, answers in out:
            other = meshes[first + 2]
            there = other.points @ setup.turn(first)
            same = other.points.shape == ball.points.shape and np.array_equal(other.cells, ball.cells)
            if same and np.abs(ball.points @ setup.turn(k) - there).max() < _SAME * setup.geometry.ball_diameter:
                out.append((first, answers))
                break
        else:
            out.append((k, _loaded(assembly, k + 2, setup.balls, floating=True)))
    return out


def _loaded(assembly: Assembly, index: int, material: tuple[float, float, float], floating: bool = False) -> LoadedBody:
    rows, body = assembly.part(index), assembly.bodies[index]
    held = np.ones(3 * assembly.nodes, dtype=bool)
    held[assembly.free] = False
    stiffness = assembly.stiffness()[rows][:, rows]
    mass = body.operator.lumped_mass() if floating else None
    return LoadedBody(body.points, body.operator.cells, stiffness, held[rows].reshape(-1, 3), mass, material)


def _moved(contact: Footprint, first: int) -> Footprint:
    return Footprint(contact.nodes + first, contact.weights, contact.share)


def _groove(setup: BearingData, race: int) -> np.ndarray:
    g, centre = setup.geometry, setup.offsets[race]
    radius = (g.conformity_outer if race else g.conformity_inner) * g.ball_diameter
    return groove(np.array([centre[0], 0.0, 0.0]), centre[1] + (0.0 if race else setup.growth), radius)


def sticking(setup: BearingData, area: np.ndarray) -> np.ndarray:
    """(n,) stiffness of sticking points [N/m3]; by default 2 (1 - nu) / (2 - nu) of a penalty's (Mindlin 1949)."""
    if setup.stick is not None:
        return np.full(len(area), setup.stick)
    nu = 0.5 * (setup.rings[1] + setup.balls[1])
    return 2.0 * (1.0 - nu) / (2.0 - nu) * penalty_stiffness(setup.modulus, 2.0 * np.sqrt(area))


def _near(points: SurfacePoints, side: np.ndarray, surface: np.ndarray, reach: float) -> SurfacePoints:
    """Points on one side of the ball whose gap in the groove is below ``reach`` [m]; whole facets, four points each."""
    x, radius = points.place[:, 0] - surface[1], np.hypot(points.place[:, 1], points.place[:, 2])
    gap = surface[5] - np.hypot(x, radius - surface[4])
    chosen = (side & (gap < reach)).reshape(-1, 4).any(axis=1)
    return points[np.repeat(chosen, 4)]
