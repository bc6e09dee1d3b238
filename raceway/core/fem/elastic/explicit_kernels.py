"""Kernels of an explicit step of one-point hexahedra in contact at surface points, on the CPU and on CUDA devices.

Devices run the functions that take ``first`` and ``stride``, or one point, each thread every ``stride``-th thing from its ``first`` on.
Long sums are made in lanes, and these one after the other, so that their digits depend on the number of lanes only: one on the CPU.
An ideal cage pushes a ball with a field of rigid accelerations, m (t + w x r), which is made from six sums over the ball's nodes.
"""

from collections import namedtuple

import numpy as np
from numba import boolean, float64, int64, types, uint32, uint64, void

from raceway.core.contact.damping import add_damping
from raceway.core.fem.elastic.contact import STIFFER, forces_and_tangents, has_moved, row_sums, surface_gaps
from raceway.core.fem.elastic.friction import return_map, tangents
from raceway.core.fem.hexahedron.rows import add_parts
from raceway.core.fem.hexahedron.stiffness import Mesh, range_force
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, LAW_POINTER, MATRIX, VECTOR, record

#: Gap up to which points are evaluated [m]: surfaces take thousands of steps to travel that far.
MARGIN = 1e-6
#: Nodes that are summed and moved together, so that their forces stay in the first cache.
_CHUNK = 512

#: All bodies as one mesh: see ``raceway.core.fem.hexahedron.stiffness.Mesh``; moduli (ranges, 3); work; parts, the forces
#: by range.
Bodies = namedtuple("Bodies", "ranges cells x moduli work parts")
#: Displacement, velocity half a step earlier, acceleration, constant load, 1/m, 0 of what is held or tied, each (3 n,);
#: masses (n,).
Nodes = namedtuple("Nodes", "u half a load inverse mass")
#: First node and the one behind the last (balls, 2); t and w of the rows' fields (balls, rows, 6); their springs (balls,
#: rows); centres (balls, 3); sums of m u and m r x u (balls, lanes, 6); out: t and w of the force on a unit of mass (balls, 6).
Cages = namedtuple("Cages", "spans fields stiffness centre sums field")
#: Motion, velocity half a step earlier and acceleration (m,); outer forces by step (steps + 1, m); stiffness, damping,
#: inverse of the mass with half a step of damping (m, m); tied entries (t,) and their motion with the frame (t, m); where
#: their forces stand among the parts, and which of them each is (p,); what accelerates the frame, by lane (m, lanes) and in all (m,).
Frame = namedtuple("Frame", "q half a push stiffness damping inverse tied tie places rows sums left")
#: Surface points that may touch (k,), each field as ``Contact`` and ``CoulombFriction`` name it; ``starts``: the first of
#: each pair; ``sums``: their forces (pairs, lanes, 3); ``far``: how far a point may move before its place is looked up anew;
#: ``parts``: where the forces of their nodes (k, 8) stand; ``surface``: entries of all surfaces' nodes.
Points = namedtuple(
    "Points",
    "nodes weights x pair starts surfaces area params memory memory_trial stick committed place dissipated projected "
    "far stiffest displacement shift where velocity normal force trial direction factors bend stiffness tangent scalar sums parts surface",
)
_INTEGERS, _TABLE = int64[::1], int64[:, ::1]
_BODIES = record(Bodies, _TABLE, uint32[:, ::1], VECTOR, MATRIX, VECTOR, VECTOR)
_NODES = record(Nodes, *[VECTOR] * 6)
_CAGE = record(Cages, _TABLE, CUBE, MATRIX, MATRIX, CUBE, MATRIX)
_FRAME = record(
    Frame, VECTOR, VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, MATRIX, _INTEGERS, MATRIX, _INTEGERS, _INTEGERS, MATRIX, VECTOR
)
_POINTS = record(
    Points, _TABLE, MATRIX, MATRIX, _INTEGERS, _INTEGERS, MATRIX, VECTOR, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, MATRIX, VECTOR, MATRIX,
    VECTOR, VECTOR, *[MATRIX] * 9, *[CUBE] * 3, MATRIX, CUBE, _TABLE, _INTEGERS,
)  # fmt: skip
#: Step [s], coefficient of friction, whether tangents are symmetric, damping [N s/m3]; in and out: distance that the surfaces may have
#: travelled [m], whether a point moved or stiffened too far, and whether steps end for that; work on the frame [J], steps done; greatest
#: force [N] of the first pair, and of those that follow.
DT, COEFFICIENT, SYMMETRIC, DAMPING, TRAVEL, MOVED, STIFFENED, LEFT, WORK, DONE, PEAK = range(11)
#: Rows of ``Points.scalar``: among them energy lost in the step [J/m2], row sum of the stiffness, greatest penetration so far [m].
_GAP, _RATE, _PRESSURE, _D_GAP, _D_RATE, _LOST, _SIZE, DEEPEST = range(8)


@jit(void(int64, int64, _CAGE, VECTOR, VECTOR, VECTOR), releases=True)
def sum_balls(first, stride, cage, mass, x, u):
    """Sums of m u and m r x u over the nodes of the balls' lanes."""
    lanes = cage.sums.shape[1]
    for k in range(first, cage.sums.shape[0] * lanes, stride):
        b, lane = k // lanes, k % lanes
        c = cage.centre[b]
        p0, p1, p2, h0, h1, h2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for n in range(cage.spans[b, 0] + lane, cage.spans[b, 1], lanes):
            i = 3 * n
            m0, m1, m2 = mass[n] * u[i], mass[n] * u[i + 1], mass[n] * u[i + 2]
            r0, r1, r2 = x[i] - c[0], x[i + 1] - c[1], x[i + 2] - c[2]
            p0 += m0
            p1 += m1
            p2 += m2
            h0 += r1 * m2 - r2 * m1
            h1 += r2 * m0 - r0 * m2
            h2 += r0 * m1 - r1 * m0
        out = cage.sums[b, lane]
        out[0], out[1], out[2], out[3], out[4], out[5] = p0, p1, p2, h0, h1, h2


@jit(void(int64, int64, _CAGE), releases=True)
def push(first, stride, cage):
    """Fields of the springs on the balls' mean motions L u = t . sum(m u) + w . sum(m r x u)."""
    for b in range(first, cage.spans.shape[0], stride):
        sums, field = cage.sums[b], cage.field[b]
        for k in range(6):
            field[k] = 0.0
            for lane in range(1, sums.shape[0]):
                sums[0, k] += sums[lane, k]
        for row in range(cage.stiffness.shape[1]):
            f = cage.fields[b, row]
            mean = 0.0
            for k in range(6):
                mean += f[k] * sums[0, k]
            for k in range(6):
                field[k] += cage.stiffness[b, row] * mean * f[k]


@jit(void(int64, int64, boolean, VECTOR, LAW_POINTER, _NODES, _POINTS), releases=True)
def press(first, last, again, numbers, law, nodes, points):
    """Forces of the points ``first`` to ``last - 1``; ``again``: the trial of the step before becomes history first."""
    p, dt, rubs, part = points, numbers[DT], numbers[COEFFICIENT] > 0.0, slice(first, last)
    gap, rate, pressure = p.scalar[_GAP, part], p.scalar[_RATE, part], p.scalar[_PRESSURE, part]
    d_gap, d_rate, lost, size = p.scalar[_D_GAP, part], p.scalar[_D_RATE, part], p.scalar[_LOST, part], p.scalar[_SIZE, part]
    normal, bend, force, stiffness, tangent = p.normal[part], p.bend[part], p.force[part], p.stiffness[part], p.tangent[part]
    for i in range(first, last if again else first):
        for c in range(p.memory.shape[1]):
            p.memory[i, c] = p.memory_trial[i, c]
        if rubs:
            p.dissipated[i] += p.scalar[_LOST, i]
        for c in range(3):
            p.committed[i, c], p.place[i, c] = p.trial[i, c], p.displacement[i, c]
    for i in range(first, last):
        for c in range(3):
            u, v = 0.0, 0.0
            for j in range(8):
                at, w = 3 * p.nodes[i, j] + c, p.weights[i, j]
                u += w * nodes.u[at]
                v += w * (nodes.half[at] + 0.5 * dt * nodes.a[at])
            p.where[i, c], p.velocity[i, c] = p.x[i, c] + u, v
            p.displacement[i, c], p.shift[i, c] = u, u - p.place[i, c]
    surface_gaps(p.where[part], p.pair[part], p.surfaces, gap, normal, bend)
    for i in range(first, last):
        p.scalar[_RATE, i] = (
            p.velocity[i, 0] * p.normal[i, 0] + p.velocity[i, 1] * p.normal[i, 1] + p.velocity[i, 2] * p.normal[i, 2]
        )
    law(gap, rate, p.params[part], p.memory[part], p.memory_trial[part], dt, pressure, d_gap, d_rate)
    add_damping(numbers[DAMPING], gap, rate, pressure, d_gap, d_rate)
    # The tangents by velocity are not needed: they go where those of friction go next.
    forces_and_tangents(p.area[part], pressure, d_gap, d_rate, normal, bend, force, stiffness, tangent)
    if rubs:
        direction, factors = p.direction[part], p.factors[part]
        return_map(
            pressure, d_gap, normal, p.shift[part], p.committed[part], numbers[COEFFICIENT], p.stick[part], p.trial[part],
            direction, factors, lost,
        )  # fmt: skip
        tangents(factors, direction, normal, numbers[SYMMETRIC] > 0.0, tangent)
        for i in range(first, last):
            for c in range(3):
                p.force[i, c] -= p.area[i] * p.trial[i, c]
                for d in range(3):
                    p.stiffness[i, c, d] += p.area[i] * p.tangent[i, c, d]
    row_sums(stiffness, size)
    for i in range(first, last):
        p.scalar[DEEPEST, i] = max(p.scalar[DEEPEST, i], -p.scalar[_GAP, i])
        if p.scalar[_SIZE, i] > STIFFER * p.stiffest[i]:
            numbers[STIFFENED] = 1.0
    if has_moved(p.where[part], p.projected[part], p.far[part]):
        numbers[MOVED] = 1.0


@jit(void(int64, int64, _POINTS), releases=True)
def sum_pairs(first, stride, points):
    """Forces of the points of the pairs' lanes."""
    lanes = points.sums.shape[1]
    for k in range(first, points.sums.shape[0] * lanes, stride):
        pair, lane = k // lanes, k % lanes
        x, y, z = 0.0, 0.0, 0.0
        for i in range(points.starts[pair] + lane, points.starts[pair + 1], lanes):
            x += points.force[i, 0]
            y += points.force[i, 1]
            z += points.force[i, 2]
        points.sums[pair, lane, 0], points.sums[pair, lane, 1], points.sums[pair, lane, 2] = x, y, z


@jit(void(int64, int64, VECTOR, _POINTS), releases=True)
def find_peaks(first, stride, numbers, points):
    """Greatest forces of the pairs so far."""
    for pair in range(first, points.sums.shape[0], stride):
        x, y, z = 0.0, 0.0, 0.0
        for lane in range(points.sums.shape[1]):
            x += points.sums[pair, lane, 0]
            y += points.sums[pair, lane, 1]
            z += points.sums[pair, lane, 2]
        numbers[PEAK + pair] = max(numbers[PEAK + pair], np.sqrt(x**2 + y**2 + z**2))


@jit(void(int64, int64, int64, _FRAME, VECTOR), releases=True)
def sum_frame(first, stride, step, frame, forces):
    """What accelerates the frame by its lanes, of the ``forces`` at its places; the first lanes take all else."""
    m, lanes = frame.sums.shape
    for k in range(first, m * lanes, stride):
        c, lane = k // lanes, k % lanes
        left = 0.0
        if lane == 0:
            left = frame.push[step + 1, c]
            for d in range(m):
                left -= frame.stiffness[c, d] * frame.q[d] + frame.damping[c, d] * frame.half[d]
        for i in range(lane, frame.places.size, lanes):
            left -= frame.tie[frame.rows[i], c] * forces[frame.places[i]]
        frame.sums[c, lane] = left


@jit(void(int64, boolean, VECTOR, _FRAME), releases=True)
def move_frame(step, onward, numbers, frame):
    """Acceleration of the frame; ``onward``: it moves on to the end of the next step.  Whether all ends here."""
    dt, m = numbers[DT], frame.q.size
    for c in range(m):
        frame.left[c] = 0.0
        for lane in range(frame.sums.shape[1]):
            frame.left[c] += frame.sums[c, lane]
        numbers[WORK] += 0.5 * (frame.push[step, c] + frame.push[step + 1, c]) * dt * frame.half[c]
    for c in range(m):
        frame.a[c] = 0.0
        for d in range(m):
            frame.a[c] += frame.inverse[c, d] * frame.left[d]
        if onward:
            frame.half[c] += dt * frame.a[c]
            frame.q[c] += dt * frame.half[c]
    numbers[DONE], numbers[LEFT] = step + 1, max(numbers[MOVED], numbers[STIFFENED])


@jit(void(int64, int64, _NODES, _FRAME), releases=True)
def carry(first, stride, nodes, frame):
    """What is tied to the frame follows it."""
    for i in range(first, frame.tied.size, stride):
        u, half, a = 0.0, 0.0, 0.0
        for c in range(frame.q.size):
            u += frame.tie[i, c] * frame.q[c]
            half += frame.tie[i, c] * frame.half[c]
            a += frame.tie[i, c] * frame.a[c]
        nodes.u[frame.tied[i]], nodes.half[frame.tied[i]], nodes.a[frame.tied[i]] = u, half, a


@jit(types.UniTuple(float64, 3)(int64, int64, _CAGE, VECTOR), inline=True)
def field_at(b, n, cage, x):
    """Force of a ball's cage on a unit of mass at a node [m/s2]."""
    f, c, i = cage.field[b], cage.centre[b], 3 * n
    r0, r1, r2 = x[i] - c[0], x[i + 1] - c[1], x[i + 2] - c[2]
    return f[0] + f[4] * r2 - f[5] * r1, f[1] + f[5] * r0 - f[3] * r2, f[2] + f[3] * r1 - f[4] * r0


@jit(void(int64, int64, boolean, float64, _BODIES, _NODES, _CAGE), releases=True)
def move(first, last, onward, dt, bodies, nodes, cage):
    """Accelerations of the nodes ``first`` to ``last - 1``; ``onward``: they move on to the end of the next step."""
    u, half, a, load, inverse, mass = nodes
    for begin in range(first, last, _CHUNK):
        end = min(begin + _CHUNK, last)
        add_parts(begin, end, bodies.ranges, bodies.parts, a)
        for b in range(cage.spans.shape[0]):
            for n in range(max(begin, cage.spans[b, 0]), min(end, cage.spans[b, 1])):
                f0, f1, f2 = field_at(b, n, cage, bodies.x)
                a[3 * n] += mass[n] * f0
                a[3 * n + 1] += mass[n] * f1
                a[3 * n + 2] += mass[n] * f2
        # Unsigned: numba then checks for no index from the end, and the loops are vectorised.
        for i in range(uint64(3 * begin), uint64(3 * end)):
            a[i] = (load[i] - a[i]) * inverse[i]
        if onward:
            for i in range(uint64(3 * begin), uint64(3 * end)):
                half[i] += dt * a[i]
                u[i] += dt * half[i]


@jit(void(int64, boolean, VECTOR, LAW_POINTER, _BODIES, _NODES, _CAGE, _POINTS), releases=True)
def evaluate(part, again, numbers, law, bodies, nodes, cage, points):
    """Forces of all points, then fields of the cage, then forces of a range of elements into its part."""
    r = part - 2
    if part == 0:
        press(0, points.area.size, again, numbers, law, nodes, points)
    elif part == 1:
        sum_balls(0, 1, cage, nodes.mass, bodies.x, nodes.u)
        push(0, 1, cage)
    else:
        mesh = Mesh(bodies.ranges, bodies.cells, bodies.x, bodies.moduli[r])
        range_force(r, mesh, nodes.u, bodies.work, bodies.parts)


@jit(void(int64, boolean, VECTOR, _BODIES, _FRAME, _POINTS), releases=True)
def balance(step, onward, numbers, bodies, frame, points):
    """Forces of the points into the parts of their nodes, peaks, and the step of the frame."""
    for i in range(points.area.size):
        for j in range(8):
            at, w = points.parts[i, j], points.weights[i, j]
            for c in range(3):
                bodies.parts[at + c] -= w * points.force[i, c]
    sum_pairs(0, 1, points)
    find_peaks(0, 1, numbers, points)
    sum_frame(0, 1, step, frame, bodies.parts)
    move_frame(step, onward, numbers, frame)


@jit(void(VECTOR, _NODES, _FRAME, _POINTS), releases=True)
def follow(numbers, nodes, frame, points):
    """What is tied to the frame follows it; how far the surfaces travel.  Whether points have to be chosen anew."""
    carry(0, 1, nodes, frame)
    fastest = 0.0
    for i in range(points.surface.size):
        speed = abs(nodes.half[points.surface[i]])
        if not speed <= fastest:  # what is no number is kept
            fastest = speed
    numbers[TRAVEL] += 2.0 * np.sqrt(3.0) * numbers[DT] * fastest
    if not numbers[TRAVEL] <= MARGIN:
        numbers[LEFT] = 1.0


@jit(void(VECTOR, LAW_POINTER, _BODIES, _NODES, _CAGE, _FRAME, _POINTS, int64, int64), allocates=True, releases=True)
def advance(numbers, law, bodies, nodes, cage, frame, points, first, count):
    """Steps ``first`` to ``count - 1``, fewer where points have to be chosen anew."""
    step = first
    while step < count and numbers[LEFT] == 0.0:
        onward = step + 1 < count
        for part in range(bodies.ranges.shape[0] + 2):
            evaluate(part, step > first, numbers, law, bodies, nodes, cage, points)
        balance(step, onward, numbers, bodies, frame, points)
        move(0, nodes.mass.size, onward, numbers[DT], bodies, nodes, cage)
        follow(numbers, nodes, frame, points)
        step += 1
