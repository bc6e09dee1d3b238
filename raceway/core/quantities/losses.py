"""Losses of balls that roll between races, in one pass over points, balls and contacts: see ``raceway.core.quantities.rolling_friction``."""

from math import factorial, log
from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record

#: Added to a number, it leaves the nearest whole one, up to 2^51 in size, in the last bits.
_ROUND = 1.5 * 2.0**52
#: Bits of 1, and of sqrt(1/2), where mantissas begin here.
_ONE, _ROOT, _ROUND_BITS = (int(np.float64(number).view(np.int64)) for number in (1.0, np.sqrt(0.5), _ROUND))
#: log 2 in two parts, of which the first has 33 digits, so that its multiples are exact.
_LOG_2, _LOG_2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_EXPONENTIAL = tuple(1.0 / factorial(k) for k in (12, 13, 10, 11, 8, 9, 6, 7, 4, 5, 2, 3, 0, 1))
_LOGARITHM = tuple(2.0 / k for k in (17, 19, 13, 15, 9, 11, 5, 7, 1, 3))


@jit(float64(float64), inline=True)
def exponential(x):
    """e^x to 1e-15; below -708 that of -708, above 709 that of 709."""
    x = min(max(x, -708.0), 709.0)
    shifted = x * 1.4426950408889634 + _ROUND
    twos = shifted - _ROUND
    x = x - twos * _LOG_2 - twos * _LOG_2_REST
    even, odd, square = 0.0, 0.0, x * x
    for k in range(7):
        even, odd = even * square + _EXPONENTIAL[2 * k], odd * square + _EXPONENTIAL[2 * k + 1]
    return (even + odd * x) * np.int64((np.float64(shifted).view(np.int64) << 52) + _ONE).view(np.float64)


@jit(float64(float64), inline=True)
def logarithm(x):
    """log x to 1e-15, of numbers from 2.2e-308 on; of 0 -709."""
    bits = np.float64(x).view(np.int64)
    twos = (bits - _ROOT) >> 52
    mantissa = np.int64(bits - (twos << 52)).view(np.float64)
    ratio = (mantissa - 1.0) / (mantissa + 1.0)
    square = ratio * ratio
    even, odd, fourth = 0.0, 0.0, square * square
    for k in range(5):
        even, odd = even * fourth + _LOGARITHM[2 * k], odd * fourth + _LOGARITHM[2 * k + 1]
    series = even + square * odd
    twos_ = np.int64(twos + _ROUND_BITS).view(np.float64) - _ROUND
    return twos_ * _LOG_2 + (twos_ * _LOG_2_REST + ratio * series)


#: Slip by curvature stops at +-0.3473 a where spin is absent: half of the load lies inside.
_ROLLING = 0.34729635533386066**2
#: Part of the traction limit that the gyroscopic moment takes at most: beyond, balls slip sideways and the slip is not bounded.
_GYROSCOPIC_LIMIT = 0.9


class Contacts(NamedTuple):
    """Contacts of the inner race, then of the outer one.

    load, half_tangent : (n, 2 Z) [N], tangent of half the contact angle, nan where open;  root : of the load to the third [N^(1/3)]
    ratio, pitch, inertia : (1 or n, 2 Z) of ball over pitch diameter, pitch diameter [m] and ball's inertia [kg m2]
    drag : (1 or n, 2 Z) of a ball over the square of its speed [kg/m]

    The rest, (1 or n, 2 Z), stands before powers of the load Q, the entraining speed u, the radius R_x along the running direction, and
    numbers of the oil, all in SI units, in the semi-axis a Q^(1/3) across the running direction and in the terms:

    major : a;  spin : slip at the ellipse's end by spin over its rate, a E(k) Q^(1/3)
    curvature : slip at the ellipse's end by curvature over the rate of rolling, a^2 / (2 R) Q^(2/3)
    pressure : mean pressure, Q^(1/3) / (pi a b);  strain : 1 / h of the film, Q^0.067 (eta u)^-0.67 R_x^-0.464 alpha^-0.53
    slope : r^(-1/4) U^(3/4), (eta u)^0.75 R_x^-0.5;  rigid : 0.77 r^(-1/3) (b/a)^0.12 U^(2/3), (eta u)^(2/3) R_x^(-1/3)
    regime : (b/a) W / 6.6, Q R_x^-2;  front : 4 a E' R_x, Q^(1/3) R_x;  hysteresis : moment, Q^1.33
    """

    load: np.ndarray
    half_tangent: np.ndarray
    root: np.ndarray
    ratio: np.ndarray
    pitch: np.ndarray
    inertia: np.ndarray
    drag: np.ndarray
    major: np.ndarray
    spin: np.ndarray
    curvature: np.ndarray
    pressure: np.ndarray
    strain: np.ndarray
    slope: np.ndarray
    rigid: np.ndarray
    regime: np.ndarray
    front: np.ndarray
    hysteresis: np.ndarray


class _Film(NamedTuple):
    """Oil of one point: dynamic and pressure viscosity [Pa s, 1/Pa], thermal loading at 1 m/s [s2/m2], traction limit, Eyring stress [Pa]."""

    viscosity: float
    pressure_viscosity: float
    thermal: float
    traction_limit: float
    eyring_stress: float


class _Balls(NamedTuple):
    """Of the balls of one point, over the shaft's speed: rolling against the race about the contact's major axis and spin about its
    normal, R_x over half the ball's diameter, by how much the gyroscopic moment raises friction, torques on the shaft by source [N m], each
    (2 Z,); torque by the mixture, and part of the traction limit that the gyroscopic moment takes, in the first Z.

    Arrays of their own: of rows of one array the compiler cannot tell that they do not overlap, and does not vectorise the loop.
    """

    roll: np.ndarray
    spin: np.ndarray
    width: np.ndarray
    across: np.ndarray
    rolling: np.ndarray
    elastic_rolling: np.ndarray
    sliding: np.ndarray
    drag: np.ndarray
    gyroscopic: np.ndarray


_FILM, _BALLS = record(_Film, *[float64] * 5), record(_Balls, *[VECTOR] * 9)
_QUAD = float64[:, :, :, ::1]
_POINT = record(Contacts, *[VECTOR] * 17), _FILM, float64


@jit(void(*_POINT, boolean, _BALLS), inline=True)
def _ball_rates(at, film, speed, outer_race, balls):
    """Rates of balls that roll without slip at the centres of both contacts; what the gyroscopic moment takes; drag.

    In the cage's frame, with the ball's rate w_B about an axis at the angle t against the shaft's:
    (w - w_c) d_m (1 - g_i) = w_B D cos(a_i - t), w_c d_m (1 + g_o) = w_B D cos(a_o - t).  Spin: (w - w_c) sin a_i + w_B sin(a_i - t) at
    the inner race, w_B sin(a_o - t) - w_c sin a_o at the outer one.  It is 0 at tan t = sin a / (cos a +- D / d_m), + at the outer race;
    the other contact then spins by w sin a + w sin(a_i - a_o) d_m / (D (1 + v)), v = (cos(a_i - a_o) -+ g) / (1 +- g), upper signs at the
    outer race.  The gyroscopic moment acts on the ball, traction on its surface: as loads share it, or all at the outer race.

    Drag is half the density of the mixture times C_D pi D^2 / 4 and the square of the ball's speed.  Density: that of oil and of air of
    1.2 kg/m3, by volume.  A sphere alone has a C_D of 0.44 at Reynolds numbers of 1e3 to 2e5; balls in a cage shelter each other.

    Jones, J. Basic Eng. 81 (1959) 1; Harris, J. Lubr. Technol. 93 (1971) 32.  Drag: Harris & Kotzalas, Essential Concepts of Bearing
    Technology, 5th ed., chapter 10 (with the speed to the power 1.95); Schiller, Naumann, VDI Z. 77 (1933) 318 (sphere).
    """
    z = at.load.size // 2
    for i in range(z):
        o = z + i
        ratio, pitch, load_i, load_o = at.ratio[i], at.pitch[i], at.load[i], at.load[o]
        half_i, half_o = at.half_tangent[i], at.half_tangent[o]
        # Of an open contact the angle is the ball's other one.
        half_i, half_o = half_i if half_i == half_i else half_o, half_o if half_o == half_o else half_i
        half_i, half_o = half_i if half_i == half_i else 0.0, half_o if half_o == half_o else 0.0
        over_i, over_o = 2.0 / (1.0 + half_i * half_i), 2.0 / (1.0 + half_o * half_o)
        cos_i, sin_i, cos_o, sin_o = over_i - 1.0, half_i * over_i, over_o - 1.0, half_o * over_o
        width_i, width_o = 1.0 - ratio * cos_i, 1.0 + ratio * cos_o
        level, tilt = cos_i * cos_o + sin_i * sin_o, sin_i * cos_o - cos_i * sin_o
        far_i, far_o = ratio * (width_i + level + ratio * cos_i), ratio * (width_o + level - ratio * cos_o)
        loss_i = load_i * at.root[i] * at.major[i] * abs(sin_i + tilt * width_i / far_i)
        loss_o = load_o * at.root[o] * at.major[o] * abs(sin_o + tilt * width_o / far_o)
        share = loss_i / max(loss_i + loss_o, 1e-300)
        square_i, square_o = share * share, (1.0 - share) * (1.0 - share)
        by_inner, by_outer = square_i * square_i, square_o * square_o
        by_inner, by_outer = by_inner * by_inner, by_outer * by_outer
        part = 1.0 if outer_race else by_outer / (by_inner + by_outer)
        axial = part * (cos_o + ratio) + (1.0 - part) * (cos_i - ratio)
        radial = part * sin_o + (1.0 - part) * sin_i
        roll_i, roll_o = (cos_i * axial + sin_i * radial) / width_i, (cos_o * axial + sin_o * radial) / width_o
        ball = 1.0 / (ratio * (roll_i + roll_o))
        roll_i, roll_o = ball * roll_i, ball * roll_o
        balls.spin[i] = abs(ball * (sin_i * axial - cos_i * radial) + ratio * roll_i * sin_i)
        balls.spin[o] = abs(ball * (sin_o * axial - cos_o * radial) - ratio * roll_o * sin_o)
        balls.roll[i], balls.roll[o] = roll_i, roll_o
        balls.width[i], balls.width[o] = width_i, width_o
        diameter, cage = ratio * pitch, ratio * roll_o
        traction_moment = 0.5 * diameter * film.traction_limit * (load_o if outer_race else load_i + load_o)
        sideways = at.inertia[i] * abs(ball * radial) * cage * speed * speed / max(traction_moment, 1e-300)
        sideways_moment = min(sideways, _GYROSCOPIC_LIMIT)
        across = 1.0 / np.sqrt(1.0 - sideways_moment * sideways_moment)
        balls.across[i], balls.across[o] = 1.0 if outer_race else across, across
        balls.gyroscopic[i] = sideways if traction_moment > 0.0 else 0.0
        turning = 0.5 * pitch * cage
        balls.drag[i] = at.drag[i] * turning * turning * turning * speed * speed


@jit(float64(float64, float64, float64, float64), inline=True)
def _slip_below(t, h, spin, c):
    square = t * t
    return square * (spin * (0.5 - 0.25 * square)) + t * h * (square * (1.0 / 3.0 - 0.2 * square + c / 3.0) - c)


@jit(float64(float64, float64), inline=True)
def mean_slip(spin, curvature):
    """Mean of the slip's size over a contact, weighted by the pressure: v = spin t + curvature (t^2 - c), t from -1 to 1 across.

    spin, curvature : speeds at the end of the ellipse, of one unit, 0 or more

    The load per width falls as 1 - t^2.  Where friction is the same in all directions, c is such that tractions balance, which is the
    least dissipation: 0 where spin is the larger, 0.1206 without spin, between them 0.1206 (1 - (spin / curvature)^2)^(3/2) to 2 %, which
    the mean hardly minds.  The slip is integrated exactly.  Limits: 3/8 spin, and 0.1611 curvature: Houpert's 0.0806 mu Q a^2 / R of
    curvature and 3/8 mu Q a of spin.
    """
    h, inverse = curvature, 1.0 / max(curvature, 1e-300)
    ratio = min(spin * inverse, 1.0)
    part = 1.0 - ratio * ratio
    c = _ROLLING * part * np.sqrt(part)
    root = spin + np.sqrt(spin * spin + 4.0 * c * h * h)
    # Zeros of the slip: the upper one always within the contact, the lower one where curvature is the larger.
    upper, lower = 2.0 * h * c / max(root, 1e-300), max(-0.5 * root * inverse, -1.0)
    return h * (0.2 - c) + 1.5 * (_slip_below(lower, h, spin, c) - _slip_below(upper, h, spin, c))


@jit(void(*_POINT, _BALLS), inline=True)
def _contact_losses(at, film, speed, balls):
    """Torque on the shaft by each contact.

    Of load Q, semi-axes a across and b along the running direction, k = a/b, entraining speed u, mean pressure p = Q / (pi a b),
    W = Q / (E' R_x^2), U = 2 eta u / (E' R_x), thermal loading L = eta beta u^2 / k_oil of the inlet:

    inlet       F_R = 2 a E' R_x ((0.77 r^(-1/3) k^-0.12 U^(2/3) - f) / (1 + M / 6.6) + f) / (1 + 0.29 L^0.78), f = 1.8 r^(-1/4) U^(3/4),
                r = 2 b E' / (3 pi p R_x), M = r^(1/4) W / k U^(-3/4): shear of the oil on each of the surfaces of a full film, half the
                integral of h dp, from the isoviscous-rigid to the elastohydrodynamic regime.  The loss is 2 u F_R, as its authors integrate
                it (their equation 38).
    hysteresis  M = 7.48e-7 (D/2)^0.33 Q^1.33 (1 - 3.519e-3 (k - 1)^0.8063) (E'_steel / E')^(1/3) in m and N; by the last factor contacts of
                the same load are smaller.  Of a ball on a plane it is 3/16 c a Q with a loss c of 2.3 % of the elastic work.
    traction    Eyring: tau = tau_E asinh(eta(p) slip / (h tau_E)), eta(p) = eta exp(alpha p) (Barus), in the central film h of Hamrock and
                Dowson, less what the inlet's heat takes, 1 / (1 + 0.254 L^0.62); at most ``traction_limit`` p.

    Inlet: Biboulet, Houpert, Proc. IMechE J 224 (2010) 777, equation 32, F_R as a moment over R_x as in the open program D-BRAIN; Aihara,
    J. Tribol. 109 (1987) 471 for the heat of the inlet, as coded there.  Hysteresis: Houpert, Tribol. Trans. 45 (2002) 345, as coded in open programs of ball screws (MER;
    one prints 3.519e-36, a misprint).  Traction: Johnson, Tevaarwerk, Proc. R. Soc. A 356 (1977) 215 (Eyring); Jacod, Venner, Lugt,
    J. Tribol. 123 (2001) 248.
    """
    log_viscosity, log_thermal = log(film.viscosity), log(film.thermal)
    steep = log_viscosity - log(film.eyring_stress) - 0.53 * log(film.pressure_viscosity)
    for c in range(at.load.size):
        q, root, rolling = at.load[c], at.root[c], balls.roll[c]
        along = 0.5 * at.ratio[c] * at.pitch[c] * balls.width[c]
        entraining = rolling * along
        log_q, log_along, log_speed = logarithm(q), logarithm(along), logarithm(entraining * speed)
        log_drag, log_loading = log_viscosity + log_speed, log_thermal + 2.0 * log_speed
        slope = at.slope[c] * exponential(0.75 * log_drag - 0.5 * log_along)
        rigid = at.rigid[c] * exponential(2.0 / 3.0 * log_drag - 1.0 / 3.0 * log_along)
        regime = at.regime[c] * q
        inlet_heating = 1.0 + 0.29 * exponential(0.78 * log_loading)
        force = at.front[c] * root * along * slope * (rigid * along * along + 1.8 * regime)
        force = force / ((slope * along * along + regime) * inlet_heating)
        slip = mean_slip(balls.spin[c] * root * at.spin[c], rolling * root * root * at.curvature[c])
        pressure = at.pressure[c] * root
        thermal_thinning = 1.0 + 0.254 * exponential(0.62 * log_loading)
        y = steep + logarithm(at.strain[c] * slip * speed * thermal_thinning) + film.pressure_viscosity * pressure
        y = max(y - 0.464 * log_along + 0.067 * log_q - 0.67 * log_drag, -300.0)
        # asinh(exp(y)) = y + log(1 + sqrt(1 + exp(-2 y)))
        stress = film.eyring_stress * (y + logarithm(1.0 + np.sqrt(1.0 + exponential(-2.0 * y))))
        sliding = min(stress, film.traction_limit * pressure) * slip * balls.across[c]
        hysteresis = rolling * at.hysteresis[c] * exponential(1.33 * log_q)
        moves = q > 0.0 and speed > 0.0
        balls.rolling[c] = entraining * force if moves else 0.0
        balls.elastic_rolling[c] = hysteresis if q > 0.0 else 0.0
        balls.sliding[c] = sliding * q / pressure if moves else 0.0


@jit(void(record(Contacts, *[MATRIX] * 17), MATRIX, VECTOR, boolean, int64[::1], _QUAD, CUBE), allocates=True, releases=True)
def ball_losses(contacts, films, speed, outer_race, row, by_contacts, by_balls):
    """Losses of n points, sums over the balls of each row.

    films : (1 or n, 5) of the oil, as in ``_Film``;  outer_race : whether it controls the spin;  row : (Z,) of each ball
    by_contacts : (n, 3, 2, rows) zeros, torque on the shaft [N m] by source - rolling, elastic rolling, sliding - and race
    by_balls : (n, 2, rows) zeros, torque by the mixture [N m], and largest part of the traction limit that a gyroscopic moment takes
    """
    c, z = contacts, row.size
    k = 2 * z
    balls = _Balls(
        np.empty(k), np.empty(k), np.empty(k), np.empty(k), np.empty(k), np.empty(k), np.empty(k), np.empty(z), np.empty(z),
    )  # fmt: skip
    one_geometry = c.ratio.shape[0] == 1
    for p in range(speed.size):
        oil, k = films[min(p, films.shape[0] - 1)], 0 if one_geometry else p
        film = _Film(oil[0], oil[1], oil[2], oil[3], oil[4])
        at = Contacts(
            c.load[p], c.half_tangent[p], c.root[p], c.ratio[k], c.pitch[k], c.inertia[k], c.drag[k], c.major[k], c.spin[k], c.curvature[k],
            c.pressure[k], c.strain[k], c.slope[k], c.rigid[k], c.regime[k], c.front[k], c.hysteresis[k],
        )  # fmt: skip
        _ball_rates(at, film, speed[p], outer_race, balls)
        _contact_losses(at, film, speed[p], balls)
        for ball in range(z):
            r = row[ball]
            for race in range(2):
                by_contacts[p, 0, race, r] += balls.rolling[race * z + ball]
                by_contacts[p, 1, race, r] += balls.elastic_rolling[race * z + ball]
                by_contacts[p, 2, race, r] += balls.sliding[race * z + ball]
            by_balls[p, 0, r] += balls.drag[ball]
            by_balls[p, 1, r] = max(by_balls[p, 1, r], balls.gyroscopic[ball])
