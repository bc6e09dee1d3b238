"""Change of stiffness by elastic rings and balls against rigid ones, without a mesh.

Notes
-----
Half-spaces under a Hertz contact give way by more than a ring's wall on a rigid seat and a ball of finite size.  The difference c, the
structural compliance of ``bodies.kind = "condensed"`` with its sign changed, is that of a layer: a ring's wall t below its groove takes
``_RING`` cos^2(alpha) / (E' t), a ball ``_BALL`` / (E' D) for both of its contacts (E' = E / (1 - nu^2)).  Each ball keeps its axial force
Q sin(alpha) and the radial distance s cos(alpha) of its groove centres, and approaches by c Q less: axially its stiffness is
k sin^2(alpha) + (Q / s) cos^2(alpha), radially that with sine and cosine exchanged, 1 / k = h - c (h Hertz's compliance).

References
----------
Fitted to condensed bodies of 23 bearings of eight series under 0.5, 2 and 8 % of C0: their changes are met within ``_WITHIN`` of themselves
(``python -m checks uncertainty``).
"""

from __future__ import annotations

import numpy as np

from raceway.bodies.model import Equilibrium, Model

#: Structural compliance times E' and wall thickness of a ring, times E' and diameter of a ball.
_RING, _BALL = 0.41, 0.91
#: How well the change is known, relative.
_WITHIN = 0.1
#: Steps to a ball's load and contact angle; least sine of that on the way.
_ITERATIONS, _LEAST = 20, 1e-3


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
    if not model.traits.contacts_alone:
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
    inner, outer = (load[loaded] for load in loads)
    angle = np.abs(0.5 * (equilibrium.angle_inner + equilibrium.angle_outer)[loaded])
    thin = _RING * np.cos(angle) ** 2 / ring * sum(1.0 / wall for wall in walls) + _BALL / (ball * b.ball_diameter)

    def approach(load: np.ndarray) -> np.ndarray:
        """Of both races [m], in the ratio that the two loads of a ball have now."""
        both = model.inner.approach(inner / mean * load) + model.outer.approach(outer / mean * load)
        return np.asarray(both)

    rest, mean = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter, 0.5 * (inner + outer)
    push, distance = mean * np.sin(angle), (rest + approach(mean)) * np.cos(angle)
    # A ball that is loaded radially keeps its load instead, and its angle: there the steps below would not converge.
    steep = rest * np.tan(angle) ** 2 > approach(mean)

    def stiffness(c: np.ndarray) -> np.ndarray:
        """Axial and radial, of all loaded balls [N/m]."""
        load, turned = mean, angle
        for _ in range(_ITERATIONS):
            length = rest + approach(load) - c * load
            turned = np.where(steep, np.arccos(np.minimum(distance / length, 1.0)), angle)
            load = np.where(steep, push / np.maximum(np.sin(turned), _LEAST), mean)
        normal, across = 1.0 / (approach(load) / (1.5 * load) - c), load / length
        sine, cosine = np.sin(turned) ** 2, np.cos(turned) ** 2
        return np.array([(normal * sine + across * cosine).sum(), (normal * cosine + across * sine).sum()])

    with np.errstate(invalid="ignore"):
        change = (stiffness(thin) / stiffness(0.0 * thin) - 1.0) * (1.0 + _WITHIN)
    if not np.isfinite(change).all():
        return "rings give way by more than the distance of their grooves"
    return {"kxx": float(change[0]), "kyy": float(change[1])}
