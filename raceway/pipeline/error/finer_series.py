"""What harmonics beyond the samples of a series of equilibria add to its 1x line.

Notes
-----
Each equilibrium is exact, and over a whole turn the Fourier line of N samples errs by the harmonics N - 1, N + 1, 2N - 1 and
so on, which no inertia keeps small.  Their sum has no order in N, and half the samples, or twice as many, may hold the same
ones: 45 and 90 samples of a motion with a mirror axis do.  A series of a larger number, which shares no divisor with N, has
other and smaller ones.

References
----------
Trefethen, Weideman, SIAM Review 56 (2014), 385 (aliasing of the trapezoidal rule).
"""

from __future__ import annotations

import attrs

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.ring.surrogate import compiled, surrogate
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress, Simulation, simulate

#: Least equilibria a turn of a second series.
_LEAST = 181


def more_equilibria(steps: int) -> int:
    """Equilibria a turn of the second series: more than twice as many, and no few."""
    return max(2 * steps + 1, _LEAST)


def finer_value(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    value: complex,
    count: int,
    on_progress: OnProgress | None = None,
) -> complex:
    """Z [N/m] of a series of ``count`` equilibria a turn, where a series of the scene's number has ``value``.

    Raises
    ------
    ConvergenceError
        An equilibrium that is not found.

    Notes
    -----
    Bodies that are stepped from Python take milliseconds an equilibrium: of them the change is that of their compiled
    surrogate, whose motion has nearly the same harmonics.
    """

    def identified(models: list[Model], steps: int) -> complex:
        records = [simulate(one, equilibrium if one is model else settle(one), on_progress, steps).record for one in models]
        return model.scene.identifier.method.identify(records, equilibrium, model).dynamic_stiffness

    models = [one for one, _ in motions]
    if compiled(model.system) is not None:
        return identified(models, count)
    models = [attrs.evolve(one, system=surrogate(one.system)) for one in models]
    steps = motions[-1][1].whole.schedule.steps_per_turn
    return value + identified(models, count) - identified(models, steps)
