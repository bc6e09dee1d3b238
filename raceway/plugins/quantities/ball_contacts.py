"""What friction is computed from at solved points: contacts of the balls, the oil between them; and Palmgren's rule of thumb."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.rolling_friction import BallContacts
from raceway.core.thermal import JET_SPEEDS, jet_oil_fraction
from raceway.framework.duties import is_foundation

if TYPE_CHECKING:
    from raceway.core.columns import Number
    from raceway.framework.contracts import SolvedPoints


#: Volume of oil over that of the space around the balls where nothing says how much there is.
_LITTLE_OIL = 0.01


#: Palmgren's f0 of an oil bath: deep groove and angular contact; half of it for oil and air, twice for jets.
_BATH = (2.0, 3.3)


#: Palmgren's f1 at a tenth of the static rating: 0.0005 0.1^0.55 and 0.001 0.1^0.33.
_LOAD_FACTORS = (1.4e-4, 4.7e-4)


def oil_fraction(points: SolvedPoints) -> Number:
    """Of the space around each ball: by the flow where [heat] has one, else that of little oil."""
    heat, rows = points.problem.heat, points.problem.bearing.of_rows
    if heat is None or isinstance(heat.oil_flow, str):
        return _LITTLE_OIL
    by_row = [jet_oil_fraction(heat.oil_flow / len(rows), points.speed, b.pitch_diameter) for b in rows]
    return np.stack(by_row, axis=-1)[:, None, points.row]


def beyond_jets(points: SolvedPoints) -> list[str]:
    """Warning of an oil fraction by the flow at speeds that its correlation was not measured at."""
    heat, oil = points.problem.heat, points.problem.lubricant
    if heat is None or isinstance(heat.oil_flow, str) or oil is None or not isinstance(oil.oil_fraction, str):
        return []
    n_dm = float(points.speed[0]) * 30e3 / pi * max(float(row.pitch_diameter) for row in points.problem.bearing.of_rows)
    low, high = JET_SPEEDS
    if low <= n_dm <= high:
        return []
    return [
        f"the oil between the balls ('auto', Parker 1984) is of jets at n d_m = {1e-6 * low:g} to {1e-6 * high:g} million mm r/min, here "
        f"{1e-6 * n_dm:.2g}: drag and heat are estimates. Give lubricant.oil_fraction where it is known"
    ]


def ball_contacts(points: SolvedPoints) -> BallContacts:
    """The contacts of all rows as the core's friction sees them."""
    rows = points.problem.bearing.of_rows

    def of_balls(numbers: list[Number]) -> np.ndarray:
        """(1 or n, 1, Z) of the numbers of the rows."""
        return np.stack(np.broadcast_arrays(*(np.atleast_1d(number) for number in numbers)), axis=-1)[:, None, points.row]

    diameter = of_balls([b.ball_diameter for b in rows])
    stiff = [2.0 / sum((1.0 - m.poisson**2) / m.young for m in (b.rings, b.balls)) for b in rows]
    races = [of_balls([getattr(b, f"conformity_{race}") for b in rows]) for race in ("inner", "outer")]
    # Ellipses of Hertz grow with the cube root of the load, those of a foundation do not.
    own = is_foundation(points.problem.contact.law)
    load = np.where(points.load > 0.0, points.load, 1.0) if own else np.ones((1, *points.load.shape[1:]))
    _, major, minor = points.ellipse(load)
    return BallContacts(
        points.load,
        points.contact_angle,
        points.row,
        major / np.cbrt(load),
        minor / np.cbrt(load),
        diameter,
        of_balls([b.pitch_diameter for b in rows]),
        np.concatenate(races, axis=1),
        of_balls(stiff),
        of_balls([b.balls.density for b in rows]) * pi * diameter**5 / 60.0,
    )


def palmgren_torque(points: SolvedPoints) -> dict[str, float]:
    """Palmgren's rule of thumb at one point [N m], by supply of oil.

    Notes
    -----
    M0 = 1e-7 f0 (nu n)^(2/3) d_m^3, 160e-7 f0 d_m^3 where nu n < 2000; M1 = f1 F d_m; in N mm, mm2/s, r/min and mm.  F is the larger of
    the radial load and 0.9 F_a cot(angle) - 0.1 F_r at the nominal angle.  Of rows the sum; a radial load is shared.

    References
    ----------
    Palmgren, Ball and Roller Bearing Engineering, 3rd ed. (1959); Harris & Kotzalas, Essential Concepts of Bearing Technology, 5th ed.,
    chapter 10.
    """
    oil, rows = points.problem.lubricant, points.problem.bearing.of_rows
    assert oil is not None, "why_not says so"
    rpm, nu = float(points.speed[0]) * 30.0 / pi, 1e6 * float(oil.kinematic_viscosity)
    radial = float(np.hypot(*points.problem.load.radial)) / len(rows)
    churned = carried = 0.0
    for row, b in enumerate(rows):
        balls, kind = points.row == row, int(b.contact_angle > 0.1)
        pitch = 1e3 * b.pitch_diameter
        axial = np.nansum(points.load[0, 1, balls] * np.abs(np.sin(points.contact_angle[0, 1, balls])))
        angle = max(b.contact_angle, float(np.nanmean(np.abs(points.contact_angle[0, 1, balls]))) if kind == 0 else 0.0, 0.1)
        churned += 1e-7 * _BATH[kind] * max(nu * rpm, 2000.0) ** (2.0 / 3.0) * pitch**3 if rpm > 0.0 else 0.0
        carried += _LOAD_FACTORS[kind] * max(radial, 0.9 * float(axial) / np.tan(angle) - 0.1 * radial) * pitch
    supplies = {"oil_and_air": 0.5, "oil_bath": 1.0, "oil_jet": 2.0}
    return {name: 1e-3 * (supply * churned + carried) for name, supply in supplies.items()}
