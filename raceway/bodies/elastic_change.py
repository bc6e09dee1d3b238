"""Change of stiffness by elastic rings and balls against rigid ones, without a mesh.

Notes
-----
Half-spaces under a Hertz contact give way by more than a ring's wall on a rigid seat and a ball of finite size.  The difference, the
structural compliance c of ``bodies.kind = "condensed"``, is that of a layer: a ring's wall t below its groove takes off
``_RING`` cos^2(alpha) / (E' t), a ball ``_BALL`` / (E' D) for both of its contacts (E' = E / (1 - nu^2)).  A ball's normal stiffness grows by
kappa = c / (h - c), h Hertz's compliance of both contacts at their loads, kyy by kappa (1 + kappa) at most, kxx, whose contact angle
grows less, by kappa at most.

References
----------
Fitted to condensed bodies of 23 bearings of eight series under 0.5, 2 and 8 % of C0: kyy's change is met within ``_WITHIN`` of itself
(``python -m benchmarks.checks elastic_change``).
"""

from __future__ import annotations

import numpy as np

from raceway.bodies.model import Equilibrium, Model

#: Structural compliance times E' and wall thickness of a ring, times E' and diameter of a ball.
_RING, _BALL = 0.41, 0.91
#: How well the change is known, relative.
_WITHIN = 0.1


def elastic_change(model: Model, equilibrium: Equilibrium) -> dict[str, float] | str:
    """Relative change of ``kxx`` and ``kyy`` on rigid seats, at most; or why there is none.

    Parameters
    ----------
    model : rigid bodies
    equilibrium : its static state

    Notes
    -----
    Seats that give way change the sign: ``supports.outer_seat`` and ``inner_seat`` of condensed bodies.
    """
    b, z = model.problem.bearing, model.system.ball_count
    if model.problem.bodies.name != "rigid":
        return f"bodies.kind = '{model.problem.bodies.name}'"
    if b.bore is None or b.outer_diameter is None or not b.equal_rows:
        return "needs `bearing.bore` and `bearing.outer_diameter` of equal rows"
    ring, ball = (material.young / (1.0 - material.poisson**2) for material in (b.rings, b.balls))
    walls = (
        0.5 * (b.pitch_diameter - b.ball_diameter - b.bore),
        0.5 * (b.outer_diameter - b.pitch_diameter - b.ball_diameter),
    )
    loads = equilibrium.contact_force[:z], equilibrium.contact_force[z:]
    loaded = (loads[0] > 0.0) & (loads[1] > 0.0)
    if not loaded.any() or min(walls) <= 0.0:
        return "no loaded ball" if min(walls) > 0.0 else "no wall below the grooves"
    hertz = sum(
        2.0 / 3.0 * ellipse.approach(load[loaded]) / load[loaded]
        for ellipse, load in zip((model.inner, model.outer), loads, strict=True)
    )
    cosines = np.cos(equilibrium.angle_inner[loaded]) ** 2
    compliance = _RING * cosines / ring * sum(1.0 / wall for wall in walls) + _BALL / (ball * b.ball_diameter)
    kappa = float(np.mean(compliance / (hertz - compliance))) * (1.0 + _WITHIN)
    return {"kxx": kappa, "kyy": kappa * (1.0 + kappa)}
