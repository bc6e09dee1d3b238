"""Plan of contacts at surface points of condensed bodies: their limits and cost."""

from __future__ import annotations

import attrs

from raceway.errors import Mistake
from raceway.scene.scene import Scene

#: Points along each semi-axis where the scene says nothing.
NODES = 4
#: Bytes that patches may take.
_LIMIT = 4 * 2**30
#: Seconds of processor time, measured on one core of a small server for 12 balls: compliances that are not kept from
#: before, an equilibrium and a step, each a constant and a part that grows with the square of the points per semi-axis.
_SETUP_S, _EQUILIBRIUM_S, _STEP_S = (1.0, 0.07), (0.020, 0.0068), (0.010, 0.0012)
#: The orbit of a first guess, over a step.
MOTION = 150.0
#: Evaluations of a step with friction over those without: 3 and 1 (B7206C, 1 kN, 200 N rotating, 48 steps a turn).
_RUBBING = 3.0


@attrs.frozen
class PatchCost:
    """Predictions.

    Attributes
    ----------
    points : surface points that carry, of a contact at the mean load
    bytes : of compliances and factors
    setup_s, equilibrium_s, step_s : processor time [s]
    """

    points: int
    bytes: int
    setup_s: float
    equilibrium_s: float
    step_s: float


def patch_cost(scene: Scene) -> PatchCost:
    """Predicted cost of the contacts of a scene."""
    n = nodes_of(scene)
    balls = scene.bearing.balls_in_all
    points = int(3.2 * n * n)
    rows = 3.6 * n + 1.0
    # Factors of all contacts; the compliances of both rings in two directions with what is made of them on the way.
    size = 2 * balls * 1.3 * points**2 + 2 * 5.0 * rows * (2.0 * rows) ** 2
    share = balls / 12.0
    steps = _RUBBING if scene.contact.friction > 0.0 else 1.0
    return PatchCost(
        points,
        int(8.0 * size),
        _SETUP_S[0] + _SETUP_S[1] * n * n,
        share * (_EQUILIBRIUM_S[0] + _EQUILIBRIUM_S[1] * n * n),
        steps * share * (_STEP_S[0] + _STEP_S[1] * n * n),
    )


def nodes_of(scene: Scene) -> int:
    """Points along each semi-axis."""
    return int(getattr(scene.mesh, "nodes_per_semi_axis", NODES))


def patch_faults(scene: Scene) -> list[Mistake]:
    """Limits of contacts at surface points that a scene violates, each with the way out."""
    faults: list[Mistake] = []

    def refuse(bad: bool, path: str, value: object, why: str) -> None:
        if bad:
            faults.append(Mistake(path, value, why))

    instead = "use discretisation = 'resultant'"
    contact = scene.contact
    remembers = getattr(contact.law, "state_size", 0) > 0
    why = f"remembers what a contact did, but surface points of condensed bodies travel with the contact: {instead}"
    refuse(remembers, "contact.kind", contact.kind, why)
    recorded = scene.excitation is not None and "record" in scene.identifier.method.needs
    why = f"is explicit and takes contacts at surface points through too many steps: use 'newmark' or 'quasi_static', or {instead}"
    refuse(recorded and not scene.integrator.method.implicit, "integrator.kind", scene.integrator.kind, why)
    cost = patch_cost(scene)
    why = f"would take {cost.bytes / 2**30:.1f} GiB, above {_LIMIT / 2**30:.0f} GiB: take fewer points"
    refuse(cost.bytes > _LIMIT, "mesh.nodes_per_semi_axis", nodes_of(scene), why)
    return faults
