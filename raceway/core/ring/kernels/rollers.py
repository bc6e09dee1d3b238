"""Rigid rings on cylindrical rollers: line contacts cut into laminae, with the rollers' profile.

With the radial approach of both races d = y cos + z sin + growth - clearance / 2 and u = tilt_y sin - tilt_z cos, a lamina at x along
the roller, of profile P(x) = A ln[1 / (1 - (2 x / L)^2)], has the approaches d - p - x u / 2 - P at the inner race and p - x u / 2 - P
at the outer one: the roller shares the misalignment evenly, as ISO/TS 16281 has it.  The roller lies where Q_o(p) = Q_i(d - p) + F_c.
Each of n laminae carries 1 / n of what the law gives the full contact at the lamina's gap; ``ten_ninths`` is that of ``contact.kind = "line"``.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.lanes import (
    LANES,
    MASK,
    WIDTH,
    any_of,
    column_of,
    larger,
    live_of,
    multiply_add,
    put,
    rough_power,
    row_of,
    smaller,
    spread,
    take,
    where,
)
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.tensors import Pair, Tensor, pair_of, put_pair
from raceway.core.signatures import CONTACTS, LAW, MATRIX, SYSTEM, VECTOR

#: Columns of ``table`` beyond those of balls: length of the contacts [m], then the profile's drop at each lamina [m].
LENGTH, DROP = ring.COLUMNS, ring.COLUMNS + 1
_ITERATIONS = 80
#: Rows of ``work`` between the law's five and those that stay zero here: azimuth, radial approach of the races, its speed,
#: bracket of the outer approach, outer approach with its rate, misalignment u with its rate; then of every contact, summed over the
#: laminae: load, its first moment along the roller, stiffness with first and second moment, dashpot with the same.
_DIRECTION, _APPROACH, _SPEED, _BRACKET, _OUTER, _TURN = range(5, 11)
_LOAD, _MOMENT, _STIFF, _STIFF_1, _STIFF_2, _VISCOUS, _VISCOUS_1, _VISCOUS_2 = range(11, 19)


@jit(LANES(LANES), inline=True)
def ninth_root(x):
    """x^(1/9) of x >= 0, but for its last digit.

    From z near x^(-1/9): by its series z (1 + h / 9 + ...) in h = 1 - x z^9, then by that of the root, x z^8 (1 + 8 h / 9 + ...).
    """
    z = rough_power(larger(x, 1e-290), -1.0 / 9.0)
    z4 = z * z * (z * z)
    h = multiply_add(-x * z, z4 * z4, 1.0)
    series = multiply_add(h, multiply_add(h, spread(665.0 / 19683.0), 95.0 / 2187.0), 5.0 / 81.0)
    z = multiply_add(z * h, multiply_add(h, series, 1.0 / 9.0), z)
    z4 = z * z * (z * z)
    y = x * (z4 * z4)
    h = multiply_add(-y, z, 1.0)
    series = multiply_add(h, multiply_add(h, spread(15470.0 / 19683.0), 1768.0 / 2187.0), 68.0 / 81.0)
    return multiply_add(y * h, multiply_add(h, series, 8.0 / 9.0), y)


@jit(LAW)
def ten_ninths(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Q = k delta^(10/9)."""
    gaps, forces, by_gap, by_rate = row_of(gap), row_of(force), row_of(d_gap), row_of(d_rate)
    for k in range(0, gap.size, WIDTH):
        live = live_of(k, gap.size)
        approach = larger(0.0, -take(gaps, 0, k, live))  # what is no number stays none
        slope = spread(0.0)
        if any_of(approach > 0.0):
            slope = column_of(params, k, 0, live) * ninth_root(approach)
        put(forces, 0, k, live, slope * approach)
        put(by_gap, 0, k, live, (-10.0 / 9.0) * slope)
        put(by_rate, 0, k, live, 0.0)


def places(length, count):
    """(count,) middles of the laminae along a roller [m]."""
    return ((np.arange(count) + 0.5) / count - 0.5) * length


@jit(void(float64, MATRIX), inline=True)
def _add_energies(share, work):
    """Add the share of each contact's energy [J] to STORED: Q delta / (1 + m) of a law that goes with delta^m.

    Energies of systems are the law's at the gaps in ``work``, those of the middle, and STORED: what the laminae have beyond it.
    """
    for k in range(0, work.shape[1], WIDTH):
        live = live_of(k, work.shape[1])
        load, approach = take(work, rows.CONTACT_FORCE, k, live), -take(work, rows.GAP, k, live)
        energy = load * load * approach / (load - take(work, rows.FORCE_BY_GAP, k, live) * approach)
        pressed = (load > 0.0) & (approach > 0.0)
        put(work, rows.STORED, k, live, take(work, rows.STORED, k, live) + where(pressed, share * energy, 0.0))


@jit(void(float64, float64, CONTACTS, MATRIX))
def _evaluate(x, drop, contacts, work):
    """Forces of whole contacts with the gaps of the lamina at x [m], which the profile drops by so much [m]."""
    law, params, old, new, dt = contacts
    z = work.shape[1] // 2
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        (outer, own), (turn, turning) = pair_of(work, _OUTER, k, live), pair_of(work, _TURN, k, live)
        lean, leaning = 0.5 * x * turn, 0.5 * x * turning
        put_pair(work, rows.GAP, k, live, outer - take(work, _APPROACH, z + k, live) + lean + drop, lean - outer + drop)
        put_pair(work, rows.GAP_RATE, k, live, own - take(work, _SPEED, z + k, live) + leaning, leaning - own)
    force, by_gap, by_rate = work[rows.CONTACT_FORCE], work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE]
    law(work[rows.GAP], work[rows.GAP_RATE], params, old, new, dt, force, by_gap, by_rate)


@jit(void(MATRIX, int64, int64, MASK, LANES), inline=True)
def _accumulate(work, row, k, live, x):
    """Add x (lanes) to the contacts from k on of a row of sums."""
    put(work, row, k, live, take(work, row, k, live) + x)


@jit(void(boolean, CONTACTS, VECTOR, MATRIX, MATRIX))
def _sum_laminae(tangents, contacts, scalars, table, work):
    """Sums over the laminae from the places of the rollers; without tangents of loads, their moments and what moves the rollers."""
    count, length = table.shape[1] - DROP, table[0, LENGTH]
    gap, rate, force = work[rows.GAP], work[rows.GAP_RATE], work[rows.CONTACT_FORCE]
    work[_LOAD : _VISCOUS_2 + 1] = 0.0
    work[rows.STORED] = 0.0
    share = 1.0 / count
    for lamina in range(count):
        x = ((lamina + 0.5) * share - 0.5) * length
        _evaluate(x, table[0, DROP + lamina], contacts, work)
        if tangents:
            _add_energies(share, work)
        add_damping(scalars[ring.DAMPING], gap, rate, force, work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE])
        for k in range(0, gap.size, WIDTH):
            live = live_of(k, gap.size)
            load, stiff = share * take(work, rows.CONTACT_FORCE, k, live), -share * take(work, rows.FORCE_BY_GAP, k, live)
            viscous = -share * take(work, rows.FORCE_BY_RATE, k, live)
            _accumulate(work, _LOAD, k, live, load)
            _accumulate(work, _MOMENT, k, live, x * load)
            _accumulate(work, _STIFF, k, live, stiff)
            if tangents:
                _accumulate(work, _STIFF_1, k, live, x * stiff)
                _accumulate(work, _STIFF_2, k, live, x * x * stiff)
            if any_of(~(viscous == 0.0)):
                _accumulate(work, _VISCOUS, k, live, viscous)
                _accumulate(work, _VISCOUS_1, k, live, x * viscous)
                _accumulate(work, _VISCOUS_2, k, live, x * x * viscous)


@jit(MASK(int64, MASK, float64, MATRIX, MATRIX), inline=True)
def _moving(k, live, ball_gain, table, work):
    """Move the rollers from k on by Newton's method within their brackets; returns those that moved."""
    (outer, own), (low, high) = pair_of(work, _OUTER, k, live), pair_of(work, _BRACKET, k, live)
    push, (inner_load, outer_load) = column_of(table, k, ring.CENTRIFUGAL, live), pair_of(work, _LOAD, k, live)
    (stiff_i, stiff_o), (damped_i, damped_o) = pair_of(work, _STIFF, k, live), pair_of(work, _VISCOUS, k, live)
    excess = inner_load + push - outer_load
    active = live & ~(larger(excess, -excess) <= 1e-13 * (inner_load + outer_load + push))
    low, high = where(active & (excess > 0.0), outer, low), where(active & ~(excess > 0.0), outer, high)
    put_pair(work, _BRACKET, k, live, low, high)
    stiff = stiff_i + stiff_o + ball_gain * (damped_i + damped_o)
    trial = where(stiff > 0.0, outer + excess / stiff, np.inf)
    # Beyond all brackets the contact is followed from first touch, where its stiffness is none.
    halfway = where(high < np.inf, 0.5 * (low + high), 2.0 * larger(outer, 0.0) + 1e-9)
    trial = where((low < trial) & (trial < high), trial, halfway)
    active = active & ~(trial == outer)
    put_pair(work, _OUTER, k, active, trial, own + ball_gain * (trial - outer))
    return active


@jit(ring.TANGENTS(ring.TANGENTS, ring.SEATS, int64, MASK, int64, float64, MATRIX), inline=True)
def _with_rollers(total, seat, k, live, row, gain, work):
    """With the derivatives of the rollers from k on by d and u, or by their rates.

    row : of the sums that act directly, the stiffnesses or the dashpots

    With S the sum of both races' stiffness against p, dp = (k_i dd - (k_i1 - k_o1) du / 2) / S; dQ = k_i dd - k_i1 du / 2 - S_i dp and
    dM = k_i1 dd - k_i2 du / 2 - S_i1 dp; the ring feels Q along d and -M along u.
    """
    (inner, outer), (damped_i, damped_o) = pair_of(work, _STIFF, k, live), pair_of(work, _VISCOUS, k, live)
    inner, outer = inner + gain * damped_i, outer + gain * damped_o
    pressed = live & (inner + outer > 0.0)
    along = take(work, _STIFF_1, k, pressed) + gain * take(work, _VISCOUS_1, k, pressed)
    own, (first, first_o) = take(work, row, k, pressed), pair_of(work, row + 1, k, pressed)
    second, by_p, none = take(work, row + 2, k, pressed), where(pressed, 1.0 / (inner + outer), 0.0), spread(0.0)
    by_d, by_u = own * by_p, -0.5 * (first - first_o) * by_p
    radial = Tensor(none, none, none, own - inner * by_d)
    by_turn, by_centre = Pair(none, -0.5 * first - inner * by_u), Pair(none, along * by_d - first)
    return ring.with_tangent(total, seat, radial, by_turn, by_centre, 0.5 * second + along * by_u)


@jit(SYSTEM)
def rollers(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball[:, 1] is the outer approach p [m], radial; ball[:, 0] is not used.

    The difference of the sides grows with p: Newton's method within a bracket finds the one place.
    """
    ball, ball_gain, ball_history = balls
    scalars, table = constants
    f, K, C, work = response
    z, reach, cage = table.shape[0], 0.5 * table[0, LENGTH], scalars[ring.CAGE]
    ring.place(t, q, v, constants, work, (_DIRECTION, _APPROACH, _SPEED))
    tilt_y, tilt_z, turn_y, turn_z = q[3], q[4], v[3] + cage * q[4], v[4] - cage * q[3]
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        (c, s), approach = pair_of(work, _DIRECTION, k, live), take(work, _APPROACH, z + k, live)
        turn, before, pushed = (
            tilt_y * s - tilt_z * c,
            column_of(ball, k, 1, live),
            column_of(table, k, ring.CENTRIFUGAL, live) > 0.0,
        )
        edge = 0.5 * reach * larger(turn, -turn)
        low, high = smaller(approach, 0.0) - edge, where(pushed, np.inf, larger(approach, 0.0) + edge)
        # A loaded roller lies near the middle; another one that is pushed comes up from deeper than its outer contact asks for.
        kept = ((approach + 2.0 * edge > 0.0) | pushed) & ~(before == 0.0) & (low < before) & (before < high)
        outer = where(kept, before, where(pushed & (approach <= 0.0), 1e-4 * reach, 0.5 * approach))
        put_pair(work, _TURN, k, live, turn, turn_y * s - turn_z * c)
        put_pair(work, _OUTER, k, live, outer, ball_gain * outer + column_of(ball_history, k, 1, live))
        put_pair(work, _BRACKET, k, live, low, high)
    work[rows.SHIFT] = 0.0
    moving = True
    for _ in range(_ITERATIONS):
        _sum_laminae(K.size > 0, contacts, scalars, table, work)
        moving = False
        for k in range(0, z, WIDTH):
            moving |= any_of(_moving(k, live_of(k, z), ball_gain, table, work))
        if not moving:
            break
    force, stiffness, damping, none = ring.no_force(), ring.no_tangent(), ring.no_tangent(), spread(0.0)
    for k in range(z):
        ball[k, 0], ball[k, 1] = 0.0, work[_OUTER, k]
    for k in range(0, z, WIDTH):
        live = live_of(k, z)
        seat = ring.seats_of(k, live, 0.0, table, work, _DIRECTION)
        force = ring.with_force(force, seat, none, take(work, _LOAD, k, live), -take(work, _MOMENT, k, live))
        if K.size > 0:
            stiffness = _with_rollers(stiffness, seat, k, live, _STIFF, ball_gain, work)
            damping = _with_rollers(damping, seat, k, live, _VISCOUS, ball_gain, work)
    ring.put_force(force, f)
    if K.size > 0:
        ring.put_tangent(stiffness, K)
        ring.put_tangent(damping, C)
    # Gaps are those of the middle, loads those of the laminae.
    _evaluate(0.0, 0.0, contacts, work)
    if K.size > 0:
        _add_energies(-1.0, work)
    for i in range(work.shape[1]):
        work[rows.CONTACT_FORCE, i] = work[_LOAD, i]
    return 1 if moving else 0
