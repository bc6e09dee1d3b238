"""A ball on a groove, a quarter of it: the smallest model of one ball-race contact, against exact Hertz.

The ball, 9.525 mm, is pressed by its middle plane, which stays flat, onto a block whose groove has conformity 0.52 and a
rolling radius of 18.25 mm.  The block's base is held, its outer sides are free.  Elements are counted per semi-axis of the
contact ellipse at the load.
"""

import time

import attrs
import numpy as np

from checks.validation.quarter import ball_layers, half_line, quarter_ball, quarter_groove
from raceway.core.fem.elastic.assembly import Assembly, Body, Frame
from raceway.core.fem.elastic.bearing import ElasticSystem
from raceway.core.fem.elastic.contact import NodalContact, Pair, PlaceLaw, groove, penalty_stiffness
from raceway.core.fem.elastic.newton import TOLERANCE, StaticSolution
from raceway.core.fem.elastic.surface import Facets, surface_points
from raceway.extend import HexMesh, HexOperator, contact_modulus, ellipse, growing, linear
from raceway.testing import peak_at_nodes, peak_at_points

YOUNG, POISSON, DENSITY = 212e9, 0.29, 7810.0
DIAMETER, CONFORMITY, ROLLING = 9.525e-3, 0.52, 18.25e-3
RADIUS, GROOVE = 0.5 * DIAMETER, CONFORMITY * DIAMETER
MODULUS = contact_modulus(YOUNG, POISSON, YOUNG, POISSON)
_ACROSS, _ALONG = 1.0 / RADIUS - 1.0 / GROOVE, 1.0 / RADIUS + 1.0 / ROLLING
HERTZ = ellipse(_ACROSS + _ALONG, (_ALONG - _ACROSS) / (_ACROSS + _ALONG), MODULUS)
#: Of the block: angle of the groove's edge [rad], half length and depth [m]: twice what the largest ellipse here needs.
EDGE, HALF_LENGTH, DEPTH = 0.9, 6e-3, 5e-3
#: Refined zone, in semi-axes, and points that may touch, in semi-axes.
ZONE, REACH = 1.3, 3.0


@attrs.frozen(eq=False)
class Groove:
    """The quarter model under a load.

    load : of the whole ball [N];  nodes : elements per semi-axis of the race
    ball, block : HexMesh;  system : ElasticSystem, its first unknown moves the ball's middle plane
    penalty : stiffness of the penalty [N/m3]
    """

    load: float
    nodes: float
    ball: HexMesh
    block: HexMesh
    system: ElasticSystem
    penalty: float

    @property
    def cells(self) -> int:
        return len(self.ball.cells) + len(self.block.cells)


@attrs.frozen
class Answer:
    """What a solution comes to, all of the whole ball.

    cells, newton, linear : elements and iterations
    approach [m];  reaction [N];  penalty_share : of the approach, by the mean overlap weighted with pressure
    peak_points, peak_nodes : largest pressure at a quadrature point, and at a node [Pa]
    cpu : seconds to make the model and solve it
    """

    cells: int
    newton: int
    linear: int
    approach: float
    reaction: float
    penalty_share: float
    peak_points: float
    peak_nodes: float
    cpu: float


def meshes(
    load: float, nodes: float, ball_finer: float = 1.0, growth: float = 1.25, coarse: float = 0.5e-3
) -> tuple[HexMesh, HexMesh]:
    """Ball and block; the ball's rows are ``ball_finer`` times as fine as the race's."""
    major, minor = (float(x) for x in HERTZ.semi_axes(load))
    arc = 0.25 * np.pi * RADIUS

    def line(zone: float, fine: float) -> np.ndarray:
        return half_line(ZONE * zone / arc, 1.0, fine / arc / ball_finer, coarse / arc, growth)

    up = growing(1.0, coarse / arc, coarse / arc, growth)
    layers = ball_layers(RADIUS, minor / nodes / ball_finer, coarse, growth)
    ball = quarter_ball(RADIUS, line(major, major / nodes), line(minor, minor / nodes), up, layers)
    across = half_line(ZONE * major / GROOVE, EDGE, major / nodes / GROOVE, coarse / GROOVE, growth)
    along = half_line(ZONE * minor / ROLLING, HALF_LENGTH / ROLLING, minor / nodes / ROLLING, coarse / ROLLING, growth)
    block = quarter_groove(RADIUS, GROOVE, ROLLING, across, along, growing(DEPTH, minor / nodes, coarse, growth))
    return ball, block


def model(
    load: float,
    nodes: float,
    formulation: str = "incompatible",
    hourglass: float = 0.05,
    prescribed: bool = False,
    **mesh: float,
) -> Groove:
    """The model at a load [N] with so many elements per semi-axis; ``mesh``: see ``meshes``.

    prescribed : whether the first unknown keeps the value that a state gives it, and no load acts
    """
    ball, block = meshes(load, nodes, **mesh)
    major, minor = (float(x) for x in HERTZ.semi_axes(load))
    bodies = []
    for name, part in (("ball", ball), ("race", block)):
        held = np.zeros((len(part.points), 3), dtype=bool)
        held[part.nodes("side_x"), 0] = held[part.nodes("side_y"), 1] = True
        frame = None
        if name == "race":
            held[part.nodes("base")] = True
        else:
            frame = Frame(part.nodes("middle"), np.zeros(3), (2,), *np.zeros((3, 1, 1)), free=np.array([not prescribed]))
        operator = HexOperator(part.points, part.cells, YOUNG, POISSON, DENSITY, formulation, hourglass)
        bodies.append(Body(name, operator, held, frame))
    assembly = Assembly(bodies)
    found = surface_points(ball.points, ball.facet_nodes("surface"), np.zeros(3))
    near = (
        (np.abs(found.place[:, 0]) < REACH * major) & (np.abs(found.place[:, 1]) < REACH * minor) & (found.place[:, 2] < 0)
    )
    surface = groove(np.array([0.0, 0.0, -(RADIUS + ROLLING)]), ROLLING + GROOVE, GROOVE)
    facets = Facets(block.points, block.facet_nodes("raceway"))
    points = found[near]
    penalty = float(penalty_stiffness(MODULUS, minor / nodes))
    pair = Pair("ball on groove", points, surface, facets, len(ball.points))
    contact = NodalContact([pair], assembly.nodes, PlaceLaw(linear, np.full((len(points.area), 1), penalty)))
    forces = np.zeros(assembly.size)
    forces[0] = 0.0 if prescribed else -0.25 * load
    return Groove(load, nodes, ball, block, ElasticSystem(assembly, contact, MODULUS, forces), penalty)


def guess(groove_model: Groove, approach: float) -> np.ndarray:
    """(size,) the undeformed ball, moved down by ``approach`` [m]."""
    assembly = groove_model.system.assembly
    return np.concatenate([[-approach], assembly.carried[assembly.free] @ np.array([-approach])])


def solve(load: float, nodes: float, tolerance: float = TOLERANCE, **options: float | str) -> Answer:
    """Model and equilibrium under a load, to a residual relative to the forces that balance."""
    begin = time.process_time()
    found = model(load, nodes, **options)  # type: ignore[arg-type]
    state = found.system.solve_equilibrium(guess(found, float(HERTZ.approach(load))), tolerance)
    return answer(found, state, time.process_time() - begin)


def pressed(load: float, nodes: float, approach: float, **options: float | str) -> Answer:
    """The same mesh with the approach prescribed [m]: what reaction it gives."""
    begin = time.process_time()
    found = model(load, nodes, prescribed=True, **options)  # type: ignore[arg-type]
    return answer(found, found.system.solve_equilibrium(guess(found, approach)), time.process_time() - begin)


def answer(found: Groove, state: StaticSolution, cpu: float) -> Answer:
    """What a solution comes to; the contact is taken as the system last left it."""
    contact = found.system.contact
    assert contact is not None
    force = contact.area * contact.pressure
    mean = float((force * contact.pressure).sum() / max(float(force.sum()), 1e-300)) / found.penalty
    approach, reaction = -float(state.y[0]), 4.0 * float(contact.resultants()[0, 2])
    peaks = float(peak_at_points(contact)[0]), float(peak_at_nodes(contact)[0])
    iterations = state.iterations, state.linear_iterations
    return Answer(found.cells, *iterations, approach, reaction, mean / max(approach, 1e-300), *peaks, cpu)
