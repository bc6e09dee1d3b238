"""An integrator of a third party runs on every kind of bodies with its order, or is refused by the plan with the missing driver's name."""

from typing import ClassVar

import attrs
import numpy as np
import pytest

from raceway import SceneError, build_model, hookimpl, make_plan, scene_from_dict
from raceway.core.schemes.drivers import Drivers, integrate
from raceway.core.schemes.one_step.scheme import OneStep
from raceway.core.stepping.protocol import State
from raceway.core.stepping.record import Schedule
from raceway.framework.registry import Registry
from raceway.pipeline.settle import settle

BODIES = {
    "rigid": {},
    "condensed": {"bodies": {"kind": "condensed"}},
    "nodal": {
        "bodies": {"kind": "condensed"},
        "contact": {"kind": "hertz", "discretisation": "nodal"},
        "mesh": {"kind": "structured", "nodes_per_semi_axis": 2},
    },
    "elastic": {
        "bodies": {"kind": "elastic"},
        "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 12},
    },
}


def trapezoidal(system, recorder):
    """u1 = u0 + dt (v0 + v1) / 2, v1 = v0 + dt (a0 + a1) / 2."""
    dt = recorder.schedule.dt
    for step in range(1, recorder.schedule.steps + 1):
        t, before = recorder.time_of(step), recorder.state
        outer, u = recorder.load(t), before.u + dt * before.v
        for _ in range(12):
            v = 2.0 * (u - before.u) / dt - before.v
            a = 2.0 * (v - before.v) / dt - before.a
            rest = system.internal(t, dt, u, v) - outer
            change = system.solve(1.0, 2.0 / dt, 4.0 / dt**2, system.mass_times(a) + rest)
            u = u - change
            if np.abs(change).max() <= 1e-13 * np.abs(u).max():
                break
        recorder.accept(State(u, v, a, rest))


@attrs.frozen
class Stepped:
    """With a driver for systems that are stepped from Python, and no other."""

    name: ClassVar[str] = "stepped"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    @property
    def scheme(self):
        return Drivers(stepped=trapezoidal)


class ByNumbers(Stepped):
    """By the numbers of a scheme of the core: Hilber, Hughes and Taylor's method."""

    name = "by_numbers"
    dissipative = True

    @property
    def scheme(self):
        alpha = 0.1
        return OneStep(0.0, alpha, 0.25 * (1.0 + alpha) ** 2, 0.5 + alpha, 1e-11)


class Compiled(Stepped):
    """For compiled rings only."""

    name = "compiled"

    @property
    def scheme(self):
        return Drivers(compiled=OneStep().compiled)


class ThirdParty:
    @hookimpl
    def raceway_integrators(self):
        return [Stepped, ByNumbers, Compiled]


def registry():
    found = Registry(third_party=False)
    found.add(ThirdParty())
    return found


def scene(bodies, integrator):
    tables = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 1000.0},
        "rotor": {"mass": 0.5},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 20.0},
        "integrator": {"kind": integrator, "turns": 1, "start": "static"},
        **BODIES[bodies],
    }
    return scene_from_dict(tables, registry())


@pytest.mark.parametrize("integrator", ["stepped", "by_numbers"])
@pytest.mark.parametrize(
    "bodies", [pytest.param(name, marks=pytest.mark.slow) if name == "elastic" else name for name in BODIES]
)
def test_a_foreign_integrator_has_its_order_on_every_kind_of_bodies(bodies, integrator):
    """A force that grows over 0.1 ms: the error falls with the square of the step, from 10 to 20 and 40 steps."""
    chosen = scene(bodies, integrator)
    model = build_model(chosen, make_plan(chosen))
    still = settle(model)
    start = model.bearing.at_rest(model.system, still.displacement, still.ball, True)
    time = 1e-4
    ends = []
    for steps in (10, 20, 40):
        schedule = Schedule(time / steps, steps, 1, 1, time)
        record = integrate(chosen.integrator.method, model.system, start, schedule)
        ends.append(record.displacement[-1, 1:3] - still.displacement[1:3])
    first, second = np.linalg.norm(ends[0] - ends[1]), np.linalg.norm(ends[1] - ends[2])
    rate = np.log2(first / second)
    assert rate > 1.8


@pytest.mark.parametrize("bodies", ["nodal", "elastic"])
def test_a_method_without_the_driver_is_refused_by_the_plan(bodies):
    with pytest.raises(SceneError, match=r"`integrator.kind` = 'compiled': has no driver `stepped`"):
        make_plan(scene(bodies, "compiled"))
    make_plan(scene("condensed", "compiled"))
