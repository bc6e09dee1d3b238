"""Duties of integrators that solve for the steady motion (``steady = True``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.ring.system import System
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Record, Schedule
from raceway.errors import RacewayError
from raceway.testing.compiled import along_x
from raceway.testing.suite import require
from raceway.testing.systems import PRELOAD, SPEED, contact_system, counting_system, exact, linear_system, motion

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator

#: An estimate may be short of the true error by this factor; below the floor, rounding decides.
_FACTOR, _FLOOR = 3.0, 1e-9
_TURN = 2.0 * np.pi / SPEED


def own_error(record: Record) -> float:
    """The error that a record states of itself, over the motion's amplitude."""
    error = record.counts.get("error")
    require(isinstance(error, float) and np.isfinite(error) and error >= 0.0, f"counts['error'] = {error!r} is no error")
    return float(error)  # type: ignore[arg-type]


def linear_motion(method: Integrator) -> str:
    """Springs, dashpots and a gyroscopic term: the closed form within the stated error."""
    system = linear_system()
    record = integrate(method, system, motion(system, np.zeros(5), np.zeros(5)), Schedule(_TURN / 36, 36, 1))
    lines = _closed_form(system)
    wave = np.exp(1j * SPEED * record.time)[:, None]
    off = record.displacement - (wave * lines).real
    return _held(np.abs(off).max() / np.abs(lines).max(), own_error(record), "the closed form")


def contact_motion(method: Integrator) -> str:
    """A mass pushed to and fro on a Hertzian contact: the record against an integration that begins at its end."""
    resting = (PRELOAD / float(contact_system().law_params[0, 0])) ** (2.0 / 3.0)
    speed = 0.4 * np.sqrt(1.5 * PRELOAD / resting / float(contact_system().mass[0, 0]))
    system = attrs.evolve(contact_system(), force=along_x, force_params=np.array([0.5 * PRELOAD, speed]))
    start = motion(system, resting * np.array([1.0, 0.0, 0.0, 0.0, 0.0]), np.zeros(5))
    schedule = Schedule(2.0 * np.pi / speed / 36, 36, 1)
    record = integrate(method, system, start, schedule)
    q, _ = exact(system, attrs.evolve(record.final), record.time)
    size = np.ptp(q[:, 0]) / 2.0
    # A turn passes the error on, once: twice the stated error lies between the two.
    return _held(0.5 * np.abs(q - record.displacement).max() / size, own_error(record), "an integration to 1e-11")


def forgets_the_start(method: Integrator) -> str:
    """Another start and another number of turns give the same motion."""
    system = linear_system()
    still = motion(system, np.zeros(5), np.zeros(5))
    moved = motion(system, np.array([0.0, 1e-6, -2e-6, 0.0, 0.0]), np.array([0.0, 3e-3, 1e-3, 0.0, 0.0]))
    one = integrate(method, system, still, Schedule(_TURN / 36, 36, 1))
    two = integrate(method, system, moved, Schedule(_TURN / 36, 36, 2))
    off = np.abs(two.displacement - np.tile(one.displacement, (2, 1))).max() / np.abs(one.displacement).max()
    return _held(off, own_error(one) + own_error(two), "the motion from another start")


def refuses_memory(method: Integrator) -> str:
    """A law with memory is refused with a message, or its memory is committed; never ignored."""
    system = counting_system()
    start = motion(contact_system(), 1e-6 * np.array([1.0, 0.0, 0.0, 0.0, 0.0]), np.zeros(5))
    try:
        record = integrate(method, system, start, Schedule(_TURN / 36, 36, 1))
    except RacewayError as why:
        return f"refused: {why}"
    require(bool(np.all(np.diff(record.contact_force[:, 1]) > 0.0)), "the law's memory is ignored: refuse it or commit it")
    return ""


def _closed_form(system: System) -> np.ndarray:
    """Complex lines (5,) of the displacement: Re(x e^(j w t))."""
    chosen = system.free > 0.0
    now, quarter = system.outer_force(0.0), system.outer_force(0.25 * _TURN)
    force = (now - 1j * quarter)[chosen]
    parts = (system.stiffness, system.damping, system.mass)
    stiffness, damping, mass = (part[np.ix_(chosen, chosen)] for part in parts)
    lines = np.zeros(5, dtype=complex)
    lines[chosen] = np.linalg.solve(stiffness - SPEED**2 * mass + 1j * SPEED * damping, force)
    return lines


def _held(off: float, stated: float, word: str) -> str:
    require(off <= _FACTOR * stated + _FLOOR, f"off {word} by {off:.2g} of the motion; it states {stated:.2g}")
    return f"off {word} by {off:.1g}, states {stated:.1g}"
