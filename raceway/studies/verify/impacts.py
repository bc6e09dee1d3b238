"""Elastic impacts of spheres: Hertz's closed formulas, and every transient integrator that is installed against them.

Notes
-----
Two equal spheres count as one of half the mass at the relative speed.  With the approach d, m d'' + k d^1.5 = 0 gives
d_max = (5 m v^2 / (4 k))^(2/5), F_max = k d_max^1.5 and t_c = (4/5) sqrt(pi) Gamma(2/5) / Gamma(9/10) d_max / v.

References
----------
Chung, Ooi, Granular Matter 13 (2011), benchmark tests 1 and 3; Johnson, Contact Mechanics (1985), section 11.4.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gamma, pi, sqrt
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.contact.hertz import contact_modulus, ellipse
from raceway.core.ring.kernels.impact import impact_system
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Motion, Schedule
from raceway.framework.registry import Entry, Registry
from raceway.storage.tables import Tables
from raceway.studies.many.reference import Case, Number

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator

#: Peak force and contact time of an integrator at this many steps a contact, and how close they have to come: 0.1 %.
STEPS_PER_CONTACT = 100
TRANSIENT_TOLERANCE = 1e-3
#: Instants of the first touch within a step; the worst of them counts.
_PHASES = (0.0, 0.25, 0.5, 0.75)
#: d_max / v to the time of contact.
_CONTACT_TIME = 0.8 * sqrt(pi) * gamma(0.4) / gamma(0.9)


@attrs.frozen
class Impact:
    """One mass against one Hertz contact: mass [kg], relative speed [m/s], factor k [N/m^1.5]."""

    mass: float
    speed: float
    factor: float

    @property
    def largest_approach(self) -> float:
        """d_max [m]."""
        return float((1.25 * self.mass * self.speed**2 / self.factor) ** 0.4)

    @property
    def largest_force(self) -> float:
        """F_max [N]."""
        return float(self.factor * self.largest_approach**1.5)

    @property
    def contact_time(self) -> float:
        """t_c [s]."""
        return _CONTACT_TIME * self.largest_approach / self.speed


def impact_of(inputs: Tables) -> Impact:
    """The impact that a case describes; its ``type`` says what the sphere meets."""
    radius, speed = inputs["R_m"], inputs["v_each_m_s"]
    mass = inputs["rho_kg_m3"] * 4.0 / 3.0 * pi * radius**3
    young, poisson = inputs["E_Pa"], inputs["nu"]
    if inputs["type"] == "two equal spheres":
        modulus = contact_modulus(young, poisson, young, poisson)
        return Impact(0.5 * mass, 2.0 * speed, ellipse(4.0 / radius, 0.0, modulus).factor)
    modulus = young / (1.0 - poisson**2)
    return Impact(mass, speed, ellipse(2.0 / radius, 0.0, modulus).factor)


def transient_integrators(registry: Registry) -> list[Entry]:
    """Integrators that march through time with inertia.  One that finds a steady orbit instead says ``steady = True``."""
    found = [entry for entry in registry.all() if entry.kind == "integrator"]
    return [e for e in found if e.plugin.inertial and not e.plugin.steady]


def impact_of_spheres(case: Case, registry: Registry) -> Iterator[Number]:
    """Closed formulas with the factor of ``raceway.core.contact.hertz``, then each integrator."""
    impact, out = impact_of(case.inputs), case.outputs
    yield Number("peak force, closed form [N]", out["Fmax_N"], impact.largest_force, case.rel_tol)
    yield Number("largest approach, closed form [m]", out["dmax_m"], impact.largest_approach, case.rel_tol)
    yield Number("contact time, closed form [s]", out["tc_s"], impact.contact_time, case.rel_tol)
    for entry in transient_integrators(registry):
        note = ""
        force: float | None = None
        time: float | None = None
        try:
            force, time = worst_measured(entry.plugin(), impact, STEPS_PER_CONTACT)
        except Exception as why:  # a third party's own code: it is reported by name
            note = f"integrator '{entry.name}' of {entry.distribution} fails: {type(why).__name__}: {why}"
        yield Number(f"peak force, {entry.name} [N]", out["Fmax_N"], force, TRANSIENT_TOLERANCE, note)
        yield Number(f"contact time, {entry.name} [s]", out["tc_s"], time, TRANSIENT_TOLERANCE, note)


def worst_measured(method: Integrator, impact: Impact, steps: int) -> tuple[float, float]:
    """Peak force [N] and contact time [s] that lie farthest off, over touches at several instants within a step."""
    measured = [measure(method, impact, steps, phase) for phase in _PHASES]
    force = max((m[0] for m in measured), key=lambda f: abs(f - impact.largest_force))
    time = max((m[1] for m in measured), key=lambda t: abs(t - impact.contact_time))
    return force, time


def measure(method: Integrator, impact: Impact, steps: int, phase: float) -> tuple[float, float]:
    """Peak force [N] and contact time [s] of one impact at ``steps`` steps a contact.

    Parameters
    ----------
    method : an integrator
    phase : where within a step the first touch falls, in [0, 1)

    Notes
    -----
    The peak is the largest sample, not interpolated.  Times of touch and release are interpolated linearly: the mass
    flies freely before the touch, and near the release its acceleration vanishes.
    """
    from raceway.core.contact_laws.power import three_halves

    system = impact_system(impact.mass, three_halves, np.array([impact.factor]))
    dt = impact.contact_time / steps
    lead = 2.0 + phase
    ahead = np.array([-lead * dt * impact.speed, 0.0, 0.0, 0.0, 0.0])
    balls = np.zeros((1, 2))
    start = Motion(ahead, np.array([impact.speed, 0.0, 0.0, 0.0, 0.0]), np.zeros(5), balls, balls.copy())
    record = integrate(method, system, start, Schedule(dt, steps + steps // 10 + 4, 1))
    t, x = record.time, record.displacement[:, 0]
    inside = np.flatnonzero(x > 0.0)
    if len(inside) == 0 or inside[0] == 0 or inside[-1] == len(x) - 1:
        raise ValueError(f"the mass does not touch and leave within {record.schedule.steps} steps")
    touch, release = (float(t[i] - x[i] * (t[i + 1] - t[i]) / (x[i + 1] - x[i])) for i in (inside[0] - 1, inside[-1]))
    return float(record.contact_force.max()), release - touch
