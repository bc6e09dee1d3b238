"""Dynamic stiffness at one frequency: of whole turns, by least squares, of the tangent, over several whirl speeds."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.framework.contracts import Equilibrium, Model
from raceway.framework.options import between, option, worded

if TYPE_CHECKING:
    from raceway.core.record import Record
    from raceway.core.signals import Identification


def whole_turns(record: Record) -> Record:
    """The last whole turns of a record; the record itself where it holds nothing else or less than one turn."""
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    length = len(record.time) // per_turn * per_turn
    if length in (0, len(record.time)):
        return record
    names = ("time", "displacement", "velocity", "force", "gap", "contact_force", "ball")
    return attrs.evolve(record, **{name: getattr(record, name)[-length:] for name in names})


def _fourier(record: Record, frequency_hz: float) -> tuple[np.ndarray, np.ndarray]:
    """1x lines (5,) of force and displacement over a record."""
    from raceway.core.signals import synchronous_phasor

    force, displacement = (synchronous_phasor(record.time, s, frequency_hz) for s in (record.force, record.displacement))
    return force, displacement


def _spread(record: Record, z: complex, of_turn: Callable[[slice], complex]) -> float | None:
    """Largest deviation of a single turn's Z from that of all turns, relative; None for one turn."""
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    turns = len(record.time) // per_turn
    if turns < 2:
        return None
    return float(max(abs(of_turn(slice(k * per_turn, (k + 1) * per_turn)) - z) for k in range(turns)) / abs(z))


@attrs.frozen
class Fft1x:
    """Synchronous (1x) component of detrended force and displacement over full turns, with its spread over single turns."""

    name: ClassVar[str] = "fft_1x"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period"})
    synchronous: ClassVar[bool] = True
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, Fourier line over whole turns"
    )

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        from raceway.core.signals import fit_harmonics, identification, stiffness, synchronous_phasor, without_drift

        record, frequency = whole_turns(records[0]), model.excitation.frequency_hz
        time, signals = record.time, (record.force, record.displacement)
        force, line = _fourier(record, frequency)
        z = stiffness(force, line)
        fit, _ = fit_harmonics(time, np.hstack(signals), frequency, 3)
        straight = [without_drift(time, signal, frequency) for signal in signals]
        motion = record.displacement[:, :3] - record.displacement[:, :3].mean(axis=0)
        pure = (line[:3] * np.exp(1j * (2.0 * np.pi * frequency * time[:, None]))).real
        scale = np.sqrt((pure**2).sum())
        return attrs.evolve(
            identification(self.definition, frequency, force, line, model.mass_used),
            residual=float(np.sqrt(((motion - pure)[:, 1:] ** 2).sum()) / scale) if scale > 0 else None,
            spread=_spread(record, z, lambda turn: stiffness(*(synchronous_phasor(time[turn], s[turn], frequency) for s in straight))),
            window=float(abs(stiffness(fit[0, :5], fit[0, 5:]) - z) / abs(z)),
        )  # fmt: skip


@attrs.frozen
class SineFit:
    """Mean, linear drift and the first harmonics fitted together; Z from the first."""

    name: ClassVar[str] = "sine_fit"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period"})
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, least squares with drift and harmonics"
    )

    harmonics: int = option(5, help="multiples of the excitation's frequency in the fit", rule=between(1, 50))

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        from raceway.core.signals import fit_harmonics, identification, stiffness, without_drift

        record, frequency = records[0], model.excitation.frequency_hz
        signals = np.hstack([record.force, record.displacement])
        straight = without_drift(record.time, signals, frequency)

        def fitted(signals: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
            lines, residual = fit_harmonics(record.time[part], signals[part], frequency, self.harmonics)
            return lines[0], residual

        line, residual = fitted(signals, slice(None))
        z = stiffness(line[:5], line[5:])
        scale = np.linalg.norm(line[6:8]) * np.sqrt(0.5 * len(record.time))
        fourier = stiffness(*_fourier(record, frequency))
        return attrs.evolve(
            identification(self.definition, frequency, line[:5], line[5:], model.mass_used),
            residual=float(np.linalg.norm(residual[:, 6:8]) / scale) if scale > 0 else None,
            spread=_spread(record, z, lambda turn: stiffness(*np.split(fitted(straight, turn)[0], 2))),
            window=float(abs(fourier - z) / abs(z)),
        )  # fmt: skip


@attrs.frozen
class Tangent:
    """Response of M q'' + C q' + K q = F e^{jwt} with the 5x5 tangent of the equilibrium; no time integration."""

    name: ClassVar[str] = "tangent"
    needs: ClassVar[frozenset[str]] = frozenset({"equilibrium", "period"})
    definition: ClassVar[str] = (
        "tangent: small harmonic force about the static equilibrium, tilts as supported, in the direction of the force; balls "
        "between damped contacts follow at its frequency"
    )

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        from raceway.core.signals import identification

        system, excitation = model.system, model.excitation
        w = 2.0 * np.pi * excitation.frequency_hz
        samples = 64
        force = np.zeros(5, dtype=complex)
        for k in range(samples):
            phase = np.exp(-2j * np.pi * k / samples)
            force += 2.0 / samples * phase * system.outer_force(k / samples / excitation.frequency_hz)
        free = system.free > 0.0
        viscous = system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, w)
        dynamic = equilibrium.stiffness_rows_held + viscous + system.stiffness - w**2 * system.mass + 1j * w * system.damping
        line = np.zeros(5, dtype=complex)
        line[free] = np.linalg.solve(dynamic[np.ix_(free, free)], force[free])
        return identification(self.definition, excitation.frequency_hz, force, line, model.system.mass[1, 1])


#: Share by which the largest speed exceeds the smallest.  What Z has beyond its form, e w^2 with w over the mean speed, shifts K by e
#: and is seen as a misfit of e times that share: where the time step's error is as large, K is off by 1 / 0.05 = 20 times that error.
_APART = 0.05
_RULE = (
    f"at least two speeds greater than 0, the largest {100.0 * _APART:g} % or more above the smallest: closer ones make K wrong by "
    f"{1.0 / _APART:g} times the time step's error"
)


def _speeds(_instance: object, _attribute: object, value: tuple[float, ...]) -> None:
    if len(value) < 2 or min(value) <= 0.0 or max(value) < (1.0 + _APART) * min(value):
        raise ValueError(f"must be a list of {_RULE}")


@attrs.frozen
class ImpedanceFit:
    """K and C of Z(w) = K - m w^2 + j w C by least squares over whirl speeds, with known m.

    K changes with the spin speed of the balls and with the amplitude: a fitted m would take what K loses over the speeds.  So
    spin and force are held, as a shaker on a turning rotor does, and m is that of ring and rotor, as in every K of this program.
    Free tilts lean with a shape that changes with w, and gyroscopic moments are linear in w: Z is of another form then, and the
    misfit shows it.  ``window`` is the largest misfit over the whirl speeds, over |Z| there.
    """

    name: ClassVar[str] = "impedance_fit"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period", "speeds"})
    definition: ClassVar[str] = (
        "secant: K and C of Z = K - m w^2 + j w C, m known, by least squares over several whirl speeds at one spin speed"
    )

    speeds_rpm: tuple[float, ...] = option(
        unit="r/min",
        help="whirl speeds of the force at the scene's spin speed, best around the scene's own",
        rule=worded(_speeds, _RULE),
    )

    @classmethod
    def examples(cls) -> list[ImpedanceFit]:
        """Instances for the conformance suite."""
        return [cls(speeds_rpm=(7200.0, 9600.0, 12000.0, 14400.0, 16800.0))]

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        from raceway.core.signals import identification, stiffness

        records = [whole_turns(record) for record in records]
        w = np.array([2.0 * pi / (r.schedule.dt * r.schedule.steps_per_turn) for r in records])
        lines = [_fourier(record, speed / (2.0 * pi)) for record, speed in zip(records, w, strict=True)]
        z = np.array([stiffness(*line) for line in lines])
        whirl, mass = 2.0 * pi * model.excitation.frequency_hz, model.mass_used
        nearest = int(np.argmin(np.abs(w - whirl)))
        k, damping = float((z.real + mass * w**2).mean()), float((w @ z.imag) / (w @ w))
        misfit = np.abs(z - (k - mass * w**2 + 1j * w * damping))
        return attrs.evolve(
            identification(self.definition, whirl / (2.0 * pi), *lines[nearest], mass_used=mass),
            dynamic_stiffness=complex(k - mass * whirl**2, whirl * damping),
            residual=float(np.sqrt(np.mean(misfit**2)) / abs(z).mean()),
            window=float((misfit / np.abs(z)).max()),
            series=tuple((float(speed), complex(value)) for speed, value in zip(w, z, strict=True)),
        )
