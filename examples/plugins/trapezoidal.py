from typing import ClassVar

import attrs
import numpy as np

from raceway import hookimpl
from raceway.extend import Drivers, State


def steps(system, recorder):
    dt = recorder.schedule.dt
    for step in range(1, recorder.schedule.steps + 1):
        t, before = recorder.time_of(step), recorder.state
        outer, u, residuals = recorder.load(t), before.u + dt * before.v, []
        while True:
            v = 2.0 * (u - before.u) / dt - before.v
            a = 2.0 * (v - before.v) / dt - before.a
            recorder.evaluations += 1
            rest = system.internal(t, dt, u, v) - outer
            inertia = system.mass_times(a)
            residual = inertia + rest
            residuals.append(system.measure(residual))
            rounding = 1e-5 * system.measure(system.mass_times(u)) / dt**2
            forces = system.contacts()[2], system.measure(outer), system.measure(inertia), rounding
            if residuals[-1] <= 1e-9 * max(forces) + 1e-30:
                break
            if len(residuals) > 40 or not np.isfinite(residuals[-1]):
                raise recorder.stalled(residuals)
            u = u - system.solve(1.0, 2.0 / dt, 4.0 / dt**2, residual)
        recorder.accept(State(u, v, a, rest))


@attrs.frozen
class Trapezoidal:
    """The trapezoidal rule for displacement and velocity, without halved steps: for smooth motions."""

    name: ClassVar[str] = "trapezoidal"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    @property
    def scheme(self):
        return Drivers(stepped=steps)


@hookimpl
def raceway_integrators():
    return [Trapezoidal]
