"""Energy of a recorded motion and how well it balances with the work of the excitation."""

from collections.abc import Iterator

import attrs
import numpy as np

from raceway.core.contact.damping import stored_energy
from raceway.core.record import Record
from raceway.core.ring.kernels import layout
from raceway.core.ring.system import System


@attrs.frozen(eq=False)
class _FrictionEnergy:
    """Energies (n,) [J] of all contacts at each sample: stored by sticking, and lost since the first sample."""

    stored: np.ndarray
    lost: np.ndarray


def friction_energy(system: System, record: Record) -> _FrictionEnergy:
    """Energies of friction along a record; zeros where the system has none.

    A contact with the elastic tangential displacement u (``raceway.core.ring.kernels.rolling``) stores k u^2 / 2. A
    step in which its slip grows by d loses k u d with the u at the step's end: the return mapping lets the slip grow only
    along u, so no step of a record that keeps every step can give energy.
    """
    n = len(record.time)
    if system.conservative or system.scalars[layout.STICK] == 0.0:
        return _FrictionEnergy(np.zeros(n), np.zeros(n))
    slip = record.ball[:, :, 2:4]
    force = system.scalars[layout.STICK] * (_place(system, record) - slip)
    dissipation = np.zeros(n)
    dissipation[1:] = np.cumsum((force[1:] * np.diff(slip, axis=0)).sum(axis=(1, 2)))
    return _FrictionEnergy(0.5 * (force**2).sum(axis=(1, 2)) / system.scalars[layout.STICK], dissipation)


def _place(system: System, record: Record) -> np.ndarray:
    """(n, Z, 2) tangential place of the inner and the outer contact [m]; the slip is the place at which nothing pulls."""
    scalars, table = system.scalars, system.table
    cage_angle, rest_radial = scalars[layout.CAGE] * record.time, scalars[layout.REST_RADIAL]
    if system.spin is not None:
        cage_angle = system.spin.cage_angle(scalars[layout.CAGE], record.time)
        rest_radial = rest_radial + system.spin.grown(system.spin.speed(record.time))[:, None]
    azimuth = np.arctan2(table[:, layout.SINE], table[:, layout.COSINE]) + cage_angle[:, None]
    c, s = np.cos(azimuth), np.sin(azimuth)
    shift = np.broadcast_to(table[:, layout.SHIFT], azimuth.shape)
    if system.spin is not None and system.spin.shift is not None:
        second = table[:, layout.SIDE] != table[0, layout.SIDE]
        apart = table[:, layout.SHIFT] - table[second, layout.SHIFT][0]
        shift = np.where(second, system.spin.shift(system.spin.speed(record.time))[:, None] + apart, shift)
    x, y, z, tilt_y, tilt_z = (record.displacement[:, k, None] for k in range(5))
    side, lever = table[:, layout.SIDE], table[:, layout.LEVER]
    turn = side * (tilt_y * s - tilt_z * c)
    axial = scalars[layout.REST_AXIAL] + shift + side * x + scalars[layout.TILT_ARM] * turn
    radial = rest_radial + (y + lever * tilt_z) * c + (z - lever * tilt_y) * s
    p, groove_shift = record.ball, system.groove_displacement(record.ball)
    groove = scalars[layout.OFFSET_INNER] + 0.5 * scalars[layout.DIAMETER]
    inner = (
        scalars[layout.OFFSET_INNER]
        * np.arctan2(axial + groove_shift[:, :, 0] - p[:, :, 0], radial + groove_shift[:, :, 1] - p[:, :, 1])
        - groove * turn
    )
    outer = scalars[layout.OFFSET_OUTER] * np.arctan2(p[:, :, 0], p[:, :, 1])
    return np.stack([inner, outer], axis=2)


@attrs.frozen(eq=False)
class _EnergyBalance:
    """Energies (n,) [J] along a record and their drift.

    drift : largest change of kinetic + stored - work + losses, over the largest kinetic energy, work or change stored
    """

    kinetic: np.ndarray
    stored: np.ndarray
    work: np.ndarray
    losses: np.ndarray
    drift: float


def _gaps(system: System, record: Record) -> Iterator[tuple[float, np.ndarray]]:
    """Gaps (n, 2 Z) [m] of a record: of line contacts those of each lamina, with its share of the contact."""
    table = system.table
    if table.shape[1] == layout.COLUMNS:
        yield 1.0, np.ascontiguousarray(record.gap)
        return
    from raceway.core.ring.kernels import rollers

    drops = table[0, rollers.DROP :]
    azimuth = np.arctan2(table[:, layout.SINE], table[:, layout.COSINE]) + system.scalars[layout.CAGE] * record.time[:, None]
    turn = record.displacement[:, 3:4] * np.sin(azimuth) - record.displacement[:, 4:5] * np.cos(azimuth)
    for x, drop in zip(rollers.places(table[0, rollers.LENGTH], len(drops)), drops, strict=True):
        yield 1.0 / len(drops), record.gap + 0.5 * x * np.tile(turn, 2) + drop


def energy_balance(system: System, record: Record) -> _EnergyBalance:
    """Balance of kinetic and stored energy against the work of loads and excitation and the losses in dampers.

    For laws without memory, balls that do not orbit, and no gyroscopic moments.  The stored energy is integrated from the
    law itself, not from the motion, so that the balance measures the integrator; work and losses are integrals in time of
    fourth order, those of friction sums over steps of first order.
    """
    n, pairs = record.gap.shape
    energy, potential = np.empty(n * pairs), np.zeros(n)
    params = np.tile(system.law_params, (n, 1))
    memory = np.tile(system.law_state, (n, 1))
    for share, gap in _gaps(system, record):
        stored_energy(system.law, params, memory, memory.copy(), gap.reshape(-1), np.empty((6, n * pairs)), energy)
        potential += share * energy.reshape(n, pairs).sum(axis=1)
    q, v = record.displacement, record.velocity
    potential -= (record.ball[:, :, 1] * system.table[:, layout.CENTRIFUGAL]).sum(axis=1)
    potential += 0.5 * np.einsum("ni,ij,nj->n", q, system.stiffness, q) - q @ system.load
    if system.condensed:
        potential += 0.5 * np.einsum("nc,nc->n", record.contact_force, system.structural_approach(record.ball))
        potential += system.ring_energy(record.ball)
    friction = friction_energy(system, record)
    potential += friction.stored
    kinetic = 0.5 * np.einsum("ni,ij,nj->n", v, system.mass, v)
    dt = record.time[1] - record.time[0]
    work = cumulative_integral(np.einsum("ni,ni->n", record.force, v), dt)
    power = np.einsum("ni,ij,nj->n", v, system.damping, v)
    if system.scalars[layout.DAMPING] > 0.0:
        speed = np.gradient(record.gap, dt, axis=0)
        power = power + system.scalars[layout.DAMPING] * (speed**2 * (record.gap < 0.0)).sum(axis=1)
    if system.scalars[layout.TIME_CONSTANT] > 0.0:
        # What the contacts carry beyond their springs, times the approach's rate
        approach_rate = rate(record.gap, dt)
        elastic = np.empty(record.gap.shape)
        scratch = np.empty((3, record.gap.shape[1]))
        for k, gap in enumerate(np.ascontiguousarray(record.gap)):
            system.law(
                gap, scratch[2], system.law_params, system.law_state, system.law_state.copy(), 0.0, elastic[k], *scratch[:2]
            )
        power = power + ((elastic - record.contact_force) * approach_rate).sum(axis=1)
    losses = cumulative_integral(power, dt) + friction.lost
    total = kinetic + potential - work + losses
    size = max(kinetic.max(), np.ptp(potential), np.ptp(work), np.ptp(losses), 1e-300)
    return _EnergyBalance(kinetic, potential, work, losses, float(np.abs(total - total[0]).max() / size))


def rate(values: np.ndarray, dt: float) -> np.ndarray:
    """Derivative by time of samples (n, k), of fourth order inside and of second at both ends."""
    slope = np.gradient(values, dt, axis=0, edge_order=2 if len(values) > 2 else 1)
    if len(values) > 4:
        slope[2:-2] = (8.0 * (values[3:-1] - values[1:-3]) - values[4:] + values[:-4]) / (12.0 * dt)
    return np.asarray(slope)


def cumulative_integral(values: np.ndarray, dt: float) -> np.ndarray:
    """Integral from the first sample to each sample, of fourth order inside."""
    parts = 0.5 * dt * (values[1:] + values[:-1])
    if len(values) > 3:
        inner = 13.0 * (values[1:-2] + values[2:-1]) - values[:-3] - values[3:]
        parts[1:-1] = dt / 24.0 * inner
        parts[0] = dt / 12.0 * (5.0 * values[0] + 8.0 * values[1] - values[2])
        parts[-1] = dt / 12.0 * (5.0 * values[-1] + 8.0 * values[-2] - values[-3])
    return np.concatenate([[0.0], np.cumsum(parts)])
