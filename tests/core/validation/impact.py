"""A steel ball that falls on a clamped elastic block: a quarter of it, x = 0 and y = 0 being planes of symmetry."""

from typing import Any

import attrs
import numpy as np
from scipy.integrate import solve_ivp

from checks.validation.quarter import half_line
from checks.validation.reference.elastic import grid
from raceway.core.fem.elastic.assembly import Assembly, Body
from raceway.core.fem.elastic.bearing import ElasticSystem
from raceway.core.fem.elastic.contact import NodalContact, Pair, PlaceLaw, penalty_stiffness
from raceway.core.fem.elastic.surface import Facets, surface_points
from raceway.core.fem.mesh.part_meshes import ball_mesh
from raceway.extend import FACES, HexOperator, Motion, linear, solve_static

YOUNG, POISSON, DENSITY = 212e9, 0.29, 7810.0
RADIUS, HEIGHT, HALF_WIDTH = 4.7625e-3, 8e-3, 8e-3
MODULUS = YOUNG / (2.0 * (1.0 - POISSON**2))
#: Q = FACTOR delta^1.5 of a ball on a plane of the same steel (Johnson, Contact Mechanics, 1985, equation 4.23).
FACTOR = 4.0 / 3.0 * MODULUS * np.sqrt(RADIUS)


def plane(point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(8,) a plane through a point [m] as ``NodalContact`` takes surfaces; the normal points away from the body."""
    n = np.asarray(normal, dtype=float)
    return np.concatenate([[0.0], point, n / np.linalg.norm(n), [0.0]])


@attrs.frozen(eq=False)
class Impact:
    """The quarter model.

    system : ElasticSystem;  ball : nodes of the ball;  velocity : (nodes, 3) of unit speed towards the block
    mass : of the whole ball [kg], as meshed
    """

    system: ElasticSystem
    ball: slice
    velocity: np.ndarray
    mass: float

    def speed(self, v: np.ndarray) -> float:
        """Mean velocity of the ball away from the block, from the unknowns' velocities [m/s]."""
        a = self.system.assembly
        mass = a.node_mass[self.ball]
        return float(mass @ a.nodal(v).reshape(-1, 3)[self.ball, 2] / mass.sum())


def model(fine: float, zone: float, formulation: str = "one_point", hourglass: float = 0.05, growth: float = 1.5) -> Impact:
    """Elements of the size ``fine`` [m] within ``zone`` [m] of the first touch."""
    ball, block = _ball(fine, zone, growth), _block(fine, zone, growth)
    bodies = []
    for name, mesh in (("ball", ball), ("block", block)):
        points, cells = mesh
        operator = HexOperator(points, cells, YOUNG, POISSON, DENSITY, formulation, hourglass)
        held = np.abs(points) < 1e-9
        held[:, 2] = points[:, 2] < -HEIGHT + 1e-9
        held[points[:, 2] < -HEIGHT + 1e-9] = True
        bodies.append(Body(name, operator, held))
    assembly = Assembly(bodies)
    first = len(ball[0])
    under = _surface(ball, lambda p: (np.hypot(p[:, 0], p[:, 1]) < 1.2 * zone) & (p[:, 2] < RADIUS), RADIUS)
    top = _surface(block, lambda p: p[:, 2] > -1e-9, None)
    points = surface_points(ball[0], under, np.array([0.0, 0.0, RADIUS]))
    pair = Pair("ball on block", points, plane(np.zeros(3), np.array([0.0, 0.0, 1.0])), Facets(block[0], top), first)
    stiffness = penalty_stiffness(MODULUS, 2.0 * np.sqrt(points.area))
    contact = NodalContact([pair], assembly.nodes, PlaceLaw(linear, stiffness[:, None]))
    system = ElasticSystem(assembly, contact, MODULUS, np.zeros(assembly.size))
    velocity = np.zeros((assembly.nodes, 3))
    velocity[:first, 2] = -1.0
    mass = 4.0 * float(assembly.node_mass[:first].sum())
    return Impact(system, slice(0, first), velocity, mass)


def moving(stepped: ElasticSystem, velocity: np.ndarray) -> Motion:
    """Nothing displaced, nodes moving with (nodes, 3) [m/s]: the start of an impact."""
    a = stepped.assembly
    still = np.zeros(a.size)
    return stepped.motion_of(still, np.concatenate([np.zeros(a.frame_size), velocity.reshape(-1)[a.free]]), still)


def _ball(fine: float, zone: float, growth: float) -> tuple[np.ndarray, np.ndarray]:
    """Quarter of a ball that touches z = 0 at the origin."""
    lines = half_line(zone / RADIUS / (np.pi / 4.0), 1.0, fine / RADIUS / (np.pi / 4.0), 0.25, growth)
    lines = np.concatenate([-lines[:0:-1], lines])
    depth = half_line(fine, 0.5 * RADIUS, fine, 0.1 * RADIUS, growth)
    layers = 1.0 - (depth / depth[-1])[::-1]
    mesh = ball_mesh(RADIUS, lines, lines, np.linspace(-1.0, 1.0, 7), layers)
    middle = mesh.points[mesh.cells].mean(axis=1)
    used, cells = np.unique(mesh.cells[(middle[:, 0] > 0.0) & (middle[:, 1] > 0.0)], return_inverse=True)
    points = mesh.points[used]
    points[np.abs(points) < 1e-9 * RADIUS] = 0.0
    return points + [0.0, 0.0, RADIUS], cells.reshape(-1, 8)


def _block(fine: float, zone: float, growth: float) -> tuple[np.ndarray, np.ndarray]:
    """Quarter of a block below z = 0."""
    across = half_line(zone, HALF_WIDTH, fine, 0.15 * HALF_WIDTH, growth)
    down = half_line(fine, HEIGHT, fine, 0.15 * HEIGHT, growth)
    z, y, x = np.meshgrid(-down[::-1], across, across, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    return points, grid((len(across) - 1, len(across) - 1, len(down) - 1))


def _surface(mesh: tuple[np.ndarray, np.ndarray], chosen: Any, sphere: float | None) -> np.ndarray:
    """(k, 4) nodes of outer facets all of whose corners are chosen (and lie on the sphere)."""
    from raceway.extend import boundary

    points, cells = mesh
    facets = boundary(cells)
    quads = cells[facets[:, :1], FACES[facets[:, 1]]]
    good = chosen(points)
    if sphere is not None:
        good &= np.abs(np.linalg.norm(points - [0.0, 0.0, sphere], axis=1) - sphere) < 1e-6 * sphere
    return quads[good[quads].all(axis=1)]


def structural_compliances(load: float = 300.0) -> tuple[float, float]:
    """Of the clamped block and of the free ball: displacement less the half space's below the load, per load [m/N].

    Both under Hertz's pressure; the mean over depths of 1.0 to 2.5 mm, where the mesh no longer matters.  The ball's inertia
    carries the load, and its displacement is that against its centre of mass.
    """
    fine, zone, growth = 0.1e-3, 0.4e-3, 1.25
    block, ball = _block(fine, zone, growth), _ball(fine, zone, growth)
    return _under_load(block, 1.0, load, -HEIGHT), _under_load(ball, -1.0, load, None)


def _under_load(mesh: tuple[np.ndarray, np.ndarray], side: float, load: float, clamped: float | None) -> float:
    """Structural compliance of a quarter body; ``side``: 1 below z = 0, -1 above; the height that is clamped, or a free ball."""
    points, cells = mesh
    operator = HexOperator(points, cells, YOUNG, POISSON, DENSITY, "incompatible")
    a = (3.0 * load * RADIUS / (4.0 * MODULUS)) ** (1.0 / 3.0)
    sphere = None if clamped is not None else RADIUS
    top = _surface(mesh, lambda p: (side * p[:, 2] > -1e-9) if sphere is None else (p[:, 2] < RADIUS), sphere)
    at = surface_points(points, top)
    near = np.sqrt(np.maximum(1.0 - (at.place[:, :2] ** 2).sum(axis=1) / a**2, 0.0)) * (np.abs(at.place[:, 2]) < RADIUS)
    share = near * at.area
    force, mass = np.zeros_like(points), operator.lumped_mass()
    push = (-0.25 * side * load * share / share.sum())[:, None] * at.weights
    np.add.at(force[:, 2], at.nodes.ravel(), push.ravel())
    held = np.abs(points) < 1e-9
    held[:, 2] = False
    if clamped is not None:
        held[points[:, 2] < clamped + 1e-9] = True
    else:
        force[:, 2] -= force[:, 2].sum() * mass / mass.sum()
        held[np.argmax(points[:, 2]), 2] = True  # carries nothing: the forces balance
    found = solve_static(operator.stiffness(), points, force, held).displacement[:, 2]
    if clamped is None:
        found = found - mass @ found / mass.sum()
    axis = (points[:, 0] == 0.0) & (points[:, 1] == 0.0)
    depth, u = -side * points[axis, 2], -side * found[axis]
    order = np.argsort(depth)
    z = np.linspace(1.0e-3, 2.5e-3, 16)
    difference = np.interp(z, depth[order], u[order]) - load * _half_space(z, a)
    return float(difference.mean() / load)


def _half_space(z: np.ndarray, a: float) -> np.ndarray:
    """Displacement of a half space at depths z under a unit load of Hertz's pressure within the radius a [m/N].  Of a point
    load: (1 + nu) / (2 pi E) (z^2 / R^3 + 2 (1 - nu) / R) (Johnson, Contact Mechanics, equation 3.18d)."""
    r, w = np.polynomial.legendre.leggauss(24)
    r = 0.5 * (r + 1.0)
    density = w * r * np.sqrt(1.0 - r**2)
    density /= density.sum()
    far = np.sqrt((a * r[None, :]) ** 2 + z[:, None] ** 2)
    return (1.0 + POISSON) / (2.0 * np.pi * YOUNG) * ((z[:, None] ** 2 / far**3 + 2.0 * (1.0 - POISSON) / far) @ density)


@attrs.frozen
class Expected:
    """Peak force [N] and contact time [s] of a mass on Hertz's contact in series with a spring."""

    force: float
    time: float


def expected(mass: float, speed: float, compliance: float) -> Expected:
    """m x'' = -F, x = (F / FACTOR)^(2/3) + compliance F."""

    def force(x: float) -> float:
        f = FACTOR * max(x, 0.0) ** 1.5
        for _ in range(60):
            delta = max(x - compliance * f, 0.0)
            new = FACTOR * delta**1.5
            if abs(new - f) < 1e-13 * max(new, 1e-12):
                break
            slope = 1.0 + 1.5 * FACTOR * np.sqrt(delta) * compliance
            f = f - (f - new) / slope
        return f

    def leaves(t: float, s: np.ndarray) -> float:
        return float(s[0])

    leaves.terminal, leaves.direction = True, -1  # type: ignore[attr-defined]
    scale = (1.25 * mass * speed**2 / FACTOR) ** 0.4
    run = solve_ivp(
        lambda t, s: [s[1], -force(s[0]) / mass], (0.0, 20.0 * scale / speed), [1e-9 * scale, speed], "DOP853",
        events=leaves, rtol=1e-9, atol=1e-14, max_step=0.02 * scale / speed,
    )  # fmt: skip
    return Expected(max(force(x) for x in run.y[0]), float(run.t_events[0][0]))
