"""A ball between two sectors of rings, with cage, frame, penalty and friction: some dozen elements with all that a bearing's step has."""

from collections.abc import Callable
from typing import Any

import numpy as np

from raceway.core.fem.elastic.assembly import Assembly, Body, Cage, Frame
from raceway.core.fem.elastic.bearing import ElasticSystem, cage_fields, cage_rows, cage_stiffness
from raceway.core.fem.elastic.contact import NodalContact, Pair, PlaceLaw, groove
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.core.fem.elastic.surface import Facets, SurfacePoints, surface_points
from raceway.core.fem.mesh.part_meshes import ball_mesh
from raceway.extend import HexOperator, Motion, linear

YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7810.0
#: Radius of the ball, of its orbit and of the grooves' tubes, depth of the rings and overlap at the start [m].
BALL, ORBIT, TUBE, DEPTH, OVERLAP = 4e-3, 20e-3, 4.2e-3, 3e-3, 2.4e-5
#: Half the angles of a sector about the axis and about the tube [rad].
_AROUND, _ACROSS = 0.18, 0.75
#: By excitation the force on the inner ring's motions [N, N m] at a time in turns.
EXCITATIONS: dict[str, Callable[[float], np.ndarray]] = {
    "unidirectional": lambda turn: 4e3 * np.array([0.2, np.cos(2.0 * np.pi * turn), 0.0, 0.0, 1e-3]),
    "bidirectional": lambda turn: 4e3 * np.array([0.0, np.cos(2.0 * np.pi * turn), np.sin(2.0 * np.pi * turn), 1e-3, 0.0]),
}


def _sector(inner: bool, counts: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, cells and facets (k, 4) of the groove, which is the first layer."""
    around, across = (np.linspace(-a, a, n + 1) for a, n in zip((_AROUND, _ACROSS), counts, strict=True))
    side = -1.0 if inner else 1.0
    circle = ORBIT - side * (TUBE - BALL + OVERLAP)
    phi, theta, out = np.meshgrid(around, across, [0.0, DEPTH], indexing="ij")
    radius = circle + side * (TUBE + out) * np.cos(theta)
    points = np.stack([(TUBE + out) * np.sin(theta), radius * np.cos(phi), radius * np.sin(phi)], axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(phi.shape)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    corners = [a, d, c, b] if inner else [a, b, c, d]
    floor, ceiling = (np.stack([corner[..., k] for corner in corners], axis=-1).reshape(-1, 4) for k in (0, 1))
    cells = np.hstack([floor, ceiling])
    volume = np.linalg.det(points[cells[0, [1, 3, 4]]] - points[cells[0, 0]])
    return points, cells if volume > 0.0 else np.hstack([ceiling, floor]), floor


def system(
    counts: tuple[int, int] = (2, 2), lines: tuple[float, ...] = (-1.0, -0.2, 0.2, 1.0), friction: float = 0.1, damping: float = 0.0, law: Any = None,
    excitation: str = "bidirectional", period: float = 1e-6, penalty: float = 4e13, least_step: float = 0.0,
) -> ElasticSystem:  # fmt: skip
    """The system; ``lines`` of the ball's cube, ``law`` a kernel instead of the penalty's, of one parameter."""
    inner, outer = _sector(True, counts), _sector(False, counts)
    line = np.array(lines)
    ball = ball_mesh(BALL, line, line, line[[0, -1]], np.array([0.0, 1.0]))
    places = ball.points[:, [1, 2, 0]] + [0.0, ORBIT, 0.0]
    bodies = []
    for name, points, cells in (("inner", *inner[:2]), ("outer", *outer[:2]), ("ball", places, ball.cells)):
        held = np.zeros(points.shape, dtype=bool)
        seat = np.arange(1, len(points), 2)
        if name == "outer":
            held[seat] = True
        mass, still = np.diag([0.02, 0.02, 0.02, 1e-6, 1e-6]), np.array([True, True, True, True, False])
        frame = Frame(seat, np.array([1e-3, 0.0, 0.0]), (0, 1, 2, 4, 5), mass, 1e3 * mass, 1e8 * mass, still)
        operator = HexOperator(
            points, cells, YOUNG, POISSON, DENSITY * (1.0 if name == "ball" else 1.1), "one_point", 0.05, least_step
        )
        bodies.append(Body(name, operator, held, frame if name == "inner" else None))
    assembly = Assembly(bodies)
    first = int(assembly.starts[2])
    mass = assembly.own_mass[first:]
    along = np.array([0.0, 0.0, 1.0])
    centre, fields = cage_fields(places, mass, along)
    rows = cage_rows(places, mass, centre, fields)
    from scipy.sparse import csr_array

    matrix = np.zeros((4, 3 * assembly.nodes))
    matrix[:, 3 * first :] = rows
    kept = csr_array(
        (rows.ravel(), np.tile(3 * first + np.arange(rows.shape[1]), 4), rows.shape[1] * np.arange(5)), shape=matrix.shape
    )
    assembly.hold(
        Cage(kept, cage_stiffness(1e8, 2.0 * BALL, True), np.zeros(3 * assembly.nodes), fields[None], centre[None])
    )
    middle, pairs = np.array([0.0, ORBIT, 0.0]), []
    quads = ball.facet_nodes("surface")
    for race, (points, _, floor) in enumerate((inner, outer)):
        side = 2.0 * race - 1.0
        facing = quads[side * (places[quads].mean(axis=1)[:, 1] - ORBIT) > 0.8 * BALL]
        at = surface_points(places, facing, middle)
        at = SurfacePoints(at.place, at.area, at.nodes + first, at.weights)
        circle = ORBIT - side * (TUBE - BALL + OVERLAP)
        name = "inner" if race == 0 else "outer"
        surface, facets = groove(np.zeros(3), circle, TUBE), Facets(points, floor)
        pairs.append(Pair(f"ball, {name} race", at, surface, facets, int(assembly.starts[race])))
    area = np.concatenate([pair.points.area for pair in pairs])
    contact = NodalContact(
        pairs, assembly.nodes, PlaceLaw(law or linear, np.full((len(area), 1), penalty), 0, damping),
        CoulombFriction(friction, np.full(len(area), 0.8 * penalty)) if friction else None,
    )  # fmt: skip
    load = np.zeros(3 * assembly.nodes)
    load[3 * first + 1 :: 3] = 20.0 * mass / mass.sum()
    out = ElasticSystem(assembly, contact, YOUNG, assembly.reduced(load))
    out.load[:5] += [50.0, -20.0, 0.0, 0.0, 0.0]
    out.excitation = lambda t: EXCITATIONS[excitation](t / period)
    return out


def sliding(made: ElasticSystem, speed: float = 20.0, leaving: float = 20.0) -> Motion:
    """The start: the ball slides along its orbit and across, and leaves the inner ring [m/s]."""
    a = made.assembly
    velocity = np.zeros((a.nodes, 3))
    velocity[a.starts[2] :] = [0.5 * speed, leaving, speed]
    contact, still = made.contact, np.zeros(a.size)
    assert contact is not None
    if contact.friction is not None:
        contact.friction.begin(np.zeros((len(contact.area), 3)))
    return made.motion_of(still, np.concatenate([np.zeros(a.frame_size), velocity.reshape(-1)[a.free]]), still.copy())
