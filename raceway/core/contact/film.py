"""Thickness of an elastohydrodynamic film in an elliptic contact: smooth, fully flooded, isothermal; and what the inlet's heat takes.

With the entraining speed u, the viscosity eta, the pressure-viscosity coefficient alpha, E' = 2 E*, the radii R_x along and R_y
across the running direction, the load Q and the ellipticity k = a/b: U = eta u / (E' R_x), G = alpha E', W = Q / (E' R_x^2),
H = h / R_x.  The four regimes, of which the one with the thickest minimum film is named; of either film the thickest is taken, so that
both shrink with the load without a jump, and a bearing has one equilibrium:

piezoviscous-elastic   H_c = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 e^(-0.73 k)),  H_min = 3.63 U^0.68 G^0.49 W^-0.073 (1 - e^(-0.68 k))
isoviscous-elastic     H_c = 7.32 (1 - 0.72 e^(-0.28 k)) U^0.64 W^-0.22,  H_min = 7.43 U^0.65 W^-0.21 (1 - 0.85 e^(-0.31 k))
piezoviscous-rigid     H_c = H_min = 141 (G W^3 / U^2)^0.375 (1 - e^(-0.0387 R_y/R_x)) (U/W)^2
isoviscous-rigid       H_c = H_min = 128 r phi^2 (0.131 arctan(r/2) + 1.683)^2 (U/W)^2,  r = R_y/R_x,  phi = 1 / (1 + 2 / (3 r))

Seen in print: both piezoviscous-elastic formulas, the constants of the isoviscous-rigid one, and the brackets of the other two.
Not seen: 7.32, 7.43 and 141.  The latter stands for the 178 G^0.39 ... of the paper's abstract, rewritten with one exponent for
G W^3 / U^2, and a course's notes print it as 1.41, which would not meet the isoviscous-rigid film where G goes to 0.  Rolling
bearings are in the first regime; a warning says where a contact is not.  The first was fitted at k of 1 to 8 and smaller U and W
than bearings have: to 2 GPa of pressure measured films keep its power of the load (Gentle, Duckworth, Cameron), beyond k = 8 its
bracket is 1 to 0.002, and at high speeds the heat of the inlet decides (``thermal_reduction``).

Hamrock, Dowson, J. Lubr. Technol. 99 (1977) 264 (piezoviscous-elastic), 100 (1978) 236 (isoviscous-elastic); Brewe, Hamrock,
Taylor, J. Lubr. Technol. 101 (1979) 231 (isoviscous-rigid); Jeng, Hamrock, Brewe, ASLE Trans. 30 (1987) 452
(piezoviscous-rigid); Hamrock, Dowson, Ball Bearing Lubrication (1981); Hamrock, Fundamentals of Fluid Film Lubrication (1994);
Gentle, Duckworth, Cameron, J. Lubr. Technol. 97 (1975) 383.
"""

import attrs
import numpy as np

#: By number; the exponents of the load in H_c stand in the same order.
REGIMES = ("piezoviscous-elastic", "isoviscous-elastic", "piezoviscous-rigid", "isoviscous-rigid")
_BY_LOAD = np.array([-0.067, -0.22, 3.0 * 0.375 - 2.0, -2.0])


@attrs.frozen(eq=False)
class Film:
    """Films of contacts; arrays (n,)."""

    #: central, minimum : thickness [m]
    central: np.ndarray
    minimum: np.ndarray
    regime: np.ndarray  # index of ``REGIMES``
    by_load: np.ndarray  # d ln(central) / d ln(load)


def film(
    viscous: np.ndarray, alpha: np.ndarray | float, modulus: np.ndarray, along: np.ndarray, across: np.ndarray,
    load: np.ndarray, k: np.ndarray,
) -> Film:  # fmt: skip
    """Film of each contact by the regimes that hold; no film where nothing entrains.

    viscous : (n,) eta u [N/m];  alpha : pressure-viscosity coefficient [1/Pa];  modulus : (n,) E' = 2 E* [Pa]
    along, across : (n,) effective radii along and across the running direction [m];  load : (n,) [N], above 0
    k : (n,) ellipticity, a/b
    """
    speed, heavy = viscous / (modulus * along), load / (modulus * along**2)
    material = alpha * modulus
    # H_c and H_min (4, n) of all regimes
    u = np.maximum(speed, 1e-300)
    ratio = across / along
    phi = 1.0 / (1.0 + 2.0 / (3.0 * ratio))
    scale = (u / heavy) ** 2
    isoviscous = 141.0 * (material * heavy) ** 0.375 * (heavy / u) ** 0.75 * -np.expm1(-0.0387 * ratio) * scale
    rigid = 128.0 * ratio * phi**2 * (0.131 * np.arctan(0.5 * ratio) + 1.683) ** 2 * scale
    central = np.array([
        2.69 * u**0.67 * material**0.53 * heavy**-0.067 * (1.0 - 0.61 * np.exp(-0.73 * k)),
        7.32 * (1.0 - 0.72 * np.exp(-0.28 * k)) * u**0.64 * heavy**-0.22,
        isoviscous,
        rigid,
    ])  # fmt: skip
    minimum = np.array([
        3.63 * u**0.68 * material**0.49 * heavy**-0.073 * -np.expm1(-0.68 * k),
        7.43 * u**0.65 * heavy**-0.21 * (1.0 - 0.85 * np.exp(-0.31 * k)),
        isoviscous,
        rigid,
    ])  # fmt: skip
    moves = viscous > 0.0
    return Film(
        np.where(moves, central.max(axis=0) * along, 0.0),
        np.where(moves, minimum.max(axis=0) * along, 0.0),
        np.argmax(minimum, axis=0), _BY_LOAD[np.argmax(central, axis=0)],
    )  # fmt: skip


def thermal_reduction(loading: np.ndarray) -> np.ndarray:
    """Film over the isothermal film of contacts that roll without sliding and heat the oil in their inlets.

    loading : (n,) thermal loading L = eta beta u^2 / k, with beta = -d ln(eta) / dT [1/K] and k of the oil [W/m/K]

    Murch, Wilson, J. Lubr. Technol. 97 (1975) 212, as printed in Wilson, Sheu, J. Lubr. Technol. 105 (1983) 187, equation 9: a fit
    to Grubin's inlet, which does not depend on the load.
    """
    return np.asarray(1.0 / (1.0 + 0.254 * loading**0.62))


def entraining_speed(
    spin: np.ndarray | float, pitch_diameter: np.ndarray, ball_diameter: np.ndarray, inner: np.ndarray, outer: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean speed of both surfaces against the contact (n,) [m/s], of the inner and of the outer race.

    spin : speed of the inner ring [rad/s], the outer one stands;  inner, outer : (n,) contact angles [rad]

    A ball that rolls at both races without slip: with g = D cos(a) / d_m of either race the cage turns at
    w_c = w (1 - g_i) / (2 - g_i + g_o), the surfaces of the inner contact run at (w - w_c) d_m/2 (1 - g_i), those of the outer at
    w_c d_m/2 (1 + g_o), which is the same speed; of one angle w d_m/4 (1 - g^2).
    """
    gi, go = (ball_diameter * np.cos(angle) / pitch_diameter for angle in (inner, outer))
    cage = spin * (1.0 - gi) / (2.0 - gi + go)
    half = 0.5 * pitch_diameter
    return (spin - cage) * half * (1.0 - gi), cage * half * (1.0 + go)
