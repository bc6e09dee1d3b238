"""Internal force of the one-point hexahedron with exact mean gradient and stiffness hourglass control.

Notes
-----
With B_jI the integral of dN_I/dx_j over the element, V its volume and G = u B^T / V the mean displacement gradient,

    f_iI = sum_j sigma_ij(G) B_jI + kappa / 8 sum_a (gamma_a . u_i) gamma_aI,
    gamma_a = h_a - sum_j (h_a . x_j) B_j / V,   a = 4 ... 7,
    kappa = hourglass (lambda + 2 mu) B:B / V.

gamma is orthogonal to every linear field, so the patch test holds and only the twelve hourglass modes feel kappa.
Everything is done in modes (``raceway.core.hexahedron.modes``): nodes are met by additions only.

Elements go through in blocks of 16, transposed into a structure of arrays, because LLVM then vectorises the loop over
the block.  Blocks of 8 it unrolls instead, at three times the time.

References
----------
Flanagan, Belytschko, A uniform strain hexahedron and quadrilateral with orthogonal hourglass control, Int. J. Numer.
Meth. Engng 17 (1981) 679-706.
"""

from numba import float64, int64, types, uint32, uint64, void

from raceway.core.hexahedron.modes import dot6, gradient_modes, modes, nodal
from raceway.core.jit import jit

#: Elements of a block.
WIDTH = 16
#: Numbers of a block: three coordinates and three displacements of eight nodes.
WORK = 48 * WIDTH

_W = float64[::1]


@jit(types.UniTuple(float64, 7)(_W, uint64), inline=True)
def _load(w, at):
    """Modes of the eight nodal values that lie a block's width apart."""
    return modes(
        w[at], w[at + uint64(16)], w[at + uint64(32)], w[at + uint64(48)],
        w[at + uint64(64)], w[at + uint64(80)], w[at + uint64(96)], w[at + uint64(112)],
    )  # fmt: skip


@jit(void(_W, uint64, *([float64] * 7)), inline=True)
def _store(w, at, m1, m2, m3, m4, m5, m6, m7):
    """The eight nodal values of seven modes, a block's width apart."""
    f0, f1, f2, f3, f4, f5, f6, f7 = nodal(m1, m2, m3, m4, m5, m6, m7)
    w[at], w[at + uint64(16)], w[at + uint64(32)], w[at + uint64(48)] = f0, f1, f2, f3
    w[at + uint64(64)], w[at + uint64(80)], w[at + uint64(96)], w[at + uint64(112)] = f4, f5, f6, f7


@jit(void(_W, uint64, float64, float64, float64), inline=True)
def _block(w, base, lame, shear, hourglass):
    """Replace the displacements of 16 elements by their nodal forces.

    Parameters
    ----------
    w : (at least base + WORK,) float
        Coordinate c of node I of element l at ``base + (8 c + I) WIDTH + l`` [m]; the displacements follow likewise [m].
    base : int
    lame, shear, hourglass : float
        lambda, mu and hourglass (lambda + 2 mu), each over 64 [Pa].
    """
    for i in range(WIDTH):
        at = base + uint64(i)  # unsigned: numba then checks for no index from the end
        x1, x2, x3, x4, x5, x6, x7 = _load(w, at)
        y1, y2, y3, y4, y5, y6, y7 = _load(w, at + uint64(128))
        z1, z2, z3, z4, z5, z6, z7 = _load(w, at + uint64(256))
        a1, a2, a3, a4, a5, a6 = gradient_modes(y1, y2, y3, y4, y5, y6, y7, z1, z2, z3, z4, z5, z6, z7)
        b1, b2, b3, b4, b5, b6 = gradient_modes(z1, z2, z3, z4, z5, z6, z7, x1, x2, x3, x4, x5, x6, x7)
        c1, c2, c3, c4, c5, c6 = gradient_modes(x1, x2, x3, x4, x5, x6, x7, y1, y2, y3, y4, y5, y6, y7)
        r = 1.0 / dot6(a1, a2, a3, a4, a5, a6, x1, x2, x3, x4, x5, x6)  # 1 / (64 V)
        k = (
            hourglass
            * r
            * (  # kappa / 8, as B:B = squares / 512
                dot6(a1, a2, a3, a4, a5, a6, a1, a2, a3, a4, a5, a6)
                + dot6(b1, b2, b3, b4, b5, b6, b1, b2, b3, b4, b5, b6)
                + dot6(c1, c2, c3, c4, c5, c6, c1, c2, c3, c4, c5, c6)
            )
        )
        u1, u2, u3, u4, u5, u6, u7 = _load(w, at + uint64(384))
        v1, v2, v3, v4, v5, v6, v7 = _load(w, at + uint64(512))
        w1, w2, w3, w4, w5, w6, w7 = _load(w, at + uint64(640))
        uxx = r * dot6(a1, a2, a3, a4, a5, a6, u1, u2, u3, u4, u5, u6)
        uxy = r * dot6(b1, b2, b3, b4, b5, b6, u1, u2, u3, u4, u5, u6)
        uxz = r * dot6(c1, c2, c3, c4, c5, c6, u1, u2, u3, u4, u5, u6)
        uyx = r * dot6(a1, a2, a3, a4, a5, a6, v1, v2, v3, v4, v5, v6)
        uyy = r * dot6(b1, b2, b3, b4, b5, b6, v1, v2, v3, v4, v5, v6)
        uyz = r * dot6(c1, c2, c3, c4, c5, c6, v1, v2, v3, v4, v5, v6)
        uzx = r * dot6(a1, a2, a3, a4, a5, a6, w1, w2, w3, w4, w5, w6)
        uzy = r * dot6(b1, b2, b3, b4, b5, b6, w1, w2, w3, w4, w5, w6)
        uzz = r * dot6(c1, c2, c3, c4, c5, c6, w1, w2, w3, w4, w5, w6)
        bulk = lame * (uxx + uyy + uzz)
        sxy, syz, szx = shear * (uxy + uyx), shear * (uyz + uzy), shear * (uzx + uxz)
        twice = 2.0 * shear
        u4, u5 = k * (u4 - uxx * x4 - uxy * y4 - uxz * z4), k * (u5 - uxx * x5 - uxy * y5 - uxz * z5)
        u6, u7 = k * (u6 - uxx * x6 - uxy * y6 - uxz * z6), k * (u7 - uxx * x7 - uxy * y7 - uxz * z7)
        v4, v5 = k * (v4 - uyx * x4 - uyy * y4 - uyz * z4), k * (v5 - uyx * x5 - uyy * y5 - uyz * z5)
        v6, v7 = k * (v6 - uyx * x6 - uyy * y6 - uyz * z6), k * (v7 - uyx * x7 - uyy * y7 - uyz * z7)
        w4, w5 = k * (w4 - uzx * x4 - uzy * y4 - uzz * z4), k * (w5 - uzx * x5 - uzy * y5 - uzz * z5)
        w6, w7 = k * (w6 - uzx * x6 - uzy * y6 - uzz * z6), k * (w7 - uzx * x7 - uzy * y7 - uzz * z7)
        f = bulk + twice * uxx - r * (u4 * x4 + u5 * x5 + u6 * x6 + u7 * x7)
        g = sxy - r * (u4 * y4 + u5 * y5 + u6 * y6 + u7 * y7)
        h = szx - r * (u4 * z4 + u5 * z5 + u6 * z6 + u7 * z7)
        _store(
            w, at + uint64(384), f * a1 + g * b1 + h * c1, f * a2 + g * b2 + h * c2, f * a3 + g * b3 + h * c3,
            f * a4 + g * b4 + h * c4 + u4, f * a5 + g * b5 + h * c5 + u5, f * a6 + g * b6 + h * c6 + u6, u7,
        )  # fmt: skip
        f = sxy - r * (v4 * x4 + v5 * x5 + v6 * x6 + v7 * x7)
        g = bulk + twice * uyy - r * (v4 * y4 + v5 * y5 + v6 * y6 + v7 * y7)
        h = syz - r * (v4 * z4 + v5 * z5 + v6 * z6 + v7 * z7)
        _store(
            w, at + uint64(512), f * a1 + g * b1 + h * c1, f * a2 + g * b2 + h * c2, f * a3 + g * b3 + h * c3,
            f * a4 + g * b4 + h * c4 + v4, f * a5 + g * b5 + h * c5 + v5, f * a6 + g * b6 + h * c6 + v6, v7,
        )  # fmt: skip
        f = szx - r * (w4 * x4 + w5 * x5 + w6 * x6 + w7 * x7)
        g = syz - r * (w4 * y4 + w5 * y5 + w6 * y6 + w7 * y7)
        h = bulk + twice * uzz - r * (w4 * z4 + w5 * z5 + w6 * z6 + w7 * z7)
        _store(
            w, at + uint64(640), f * a1 + g * b1 + h * c1, f * a2 + g * b2 + h * c2, f * a3 + g * b3 + h * c3,
            f * a4 + g * b4 + h * c4 + w4, f * a5 + g * b5 + h * c5 + w5, f * a6 + g * b6 + h * c6 + w6, w7,
        )  # fmt: skip


@jit(void(int64, int64[:, ::1], uint32[:, ::1], _W, _W, _W, _W, _W), releases=True)
def range_force(r, ranges, cells, x, u, moduli, work, f):
    """Forces of one range of elements, into that range's part of ``f``.

    Parameters
    ----------
    r : int
        Number of the range.
    ranges : (ranges, 5) int
        First element, last element + 1, first node, last node + 1, first node's place in ``f``.
    cells : (m, 8) uint32
    x, u : (3 n,) float
        Coordinates and displacements, node by node [m].
    moduli : (3,) float
        lambda, mu, and hourglass (lambda + 2 mu) [Pa].
    work : (ranges WORK,) float
    f : (3 places,) float
        The part of this range is overwritten by its forces [N].
    """
    first, last, node, end, place = ranges[r, 0], ranges[r, 1], ranges[r, 2], ranges[r, 3], ranges[r, 4]
    for i in range(3 * place, 3 * (place + end - node)):
        f[i] = 0.0
    base = uint64(WORK * r)
    for begin in range(first, last, WIDTH):
        for i in range(WIDTH):
            e = uint64(min(begin + i, last - 1))  # the last block is filled up with its last element
            for j in range(8):
                to = base + uint64(WIDTH * j + i)
                n = uint64(3) * uint64(cells[e, uint64(j)])
                work[to], work[to + uint64(384)] = x[n], u[n]
                work[to + uint64(128)], work[to + uint64(512)] = x[n + uint64(1)], u[n + uint64(1)]
                work[to + uint64(256)], work[to + uint64(640)] = x[n + uint64(2)], u[n + uint64(2)]
        _block(work, base, moduli[0] / 64.0, moduli[1] / 64.0, moduli[2] / 64.0)
        for i in range(min(WIDTH, last - begin)):
            e = uint64(begin + i)
            for j in range(8):
                at = base + uint64(WIDTH * j + i + 384)
                n = uint64(3) * uint64(cells[e, uint64(j)] - node + place)
                f[n] += work[at]
                f[n + uint64(1)] += work[at + uint64(128)]
                f[n + uint64(2)] += work[at + uint64(256)]
