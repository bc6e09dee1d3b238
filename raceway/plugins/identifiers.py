"""Dynamic stiffness from motion: of whole turns, by least squares, of the tangent, over several whirl speeds; along a changing speed."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.errors import ConvergenceError
from raceway.framework.contracts import Equilibrium, Model
from raceway.framework.options import between, option, worded

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.record import Record
    from raceway.core.ring.ring import Ring
    from raceway.core.signals import Identification
    from raceway.framework.contracts import Equilibrium, Model


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


@attrs.frozen
class OrderTracking:
    """Least squares of the synchronous (1x) component in windows of some turns of the excitation's phase: a series over speed with errors.

    Samples have Hann's weights.  Within a window the complex amplitude A may change linearly in time; the line is taken at its
    middle.  While speed and amplitude change, M q'' of q = Re A e^{j phase} is M (-w^2 A + 2 j w A' + j w' A), and of a known
    damping C that is C (j w A + A'): what is beyond the steady terms would appear as damping m (w' + 2 w A' / A) / w and is
    subtracted.  A curvature of A would let more noise in than it takes error out: what it would change, with its own m A'', and the
    square of the change's share of the force, which steady terms of first order leave out, are the error of a window.
    """

    name: ClassVar[str] = "order_tracking"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "phase"})
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, order tracked over a changing speed, less the inertia of that change"
    )

    window_turns: float = option(6.0, help="turns in a window", rule=between(2.0, 1000.0))

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        import numpy as np

        from raceway.core.signals import identification

        record = records[0]
        phase = model.excitation.phase(record.time)
        signals = np.hstack([record.force, record.displacement])
        width = 2.0 * np.pi * self.window_turns
        series, errors, last = [], [], None
        first = phase[0]
        # A sample stands for the step that ends with it: n turns are n turns less one step from first to last sample.
        end = phase[-1] + 1.01 * (phase[-1] - phase[-2])
        while first + width <= end:
            samples = np.flatnonzero((phase >= first) & (phase < first + width))
            first += 0.5 * width
            if len(samples) < 24:
                continue
            last = _window(model, record.time[samples], phase[samples], signals[samples])
            series.append((last.speed, last.value))
            errors.append(last.error)
        if last is None:
            why = f"the record holds less than {self.window_turns:g} turns: shorten identifier.window_turns"
            raise ConvergenceError(why)
        frequency = last.speed / (2.0 * np.pi)
        return attrs.evolve(
            identification(self.definition, frequency, last.line[:5], last.line[5:], model.mass_used),
            dynamic_stiffness=last.value, residual=last.residual, series=tuple(series), series_error=tuple(errors),
        )  # fmt: skip


@attrs.frozen
class _Window:
    """Speed [rad/s], 1x line (10,) and Z [N/m] at the middle of a window, its relative error, and what is left over the line."""

    speed: float
    line: np.ndarray
    value: complex
    error: float
    residual: float | None


def _window(model: Model, time: np.ndarray, phase: np.ndarray, signals: np.ndarray) -> _Window:
    import numpy as np

    from raceway.core.signals import least_squares

    t = time - time.mean()
    span = t[-1] - t[0]
    u = t / span
    c, s = np.cos(phase), np.sin(phase)
    basis = np.column_stack([c, s, u * c, u * s, np.ones_like(u), u, u * u, np.cos(2 * phase), np.sin(2 * phase)])
    bent = np.column_stack([basis, u * u * c, u * u * s])
    # Hann's weights: a free vibration leaks less into the line by orders of magnitude.
    weight = np.sqrt(1.0 - np.cos(2.0 * np.pi * (np.arange(len(t)) + 0.5) / len(t)))[:, None]
    solution, curve = (least_squares(weight * columns, weight * signals) for columns in (basis, bent))
    # Of the phase: w at the middle, and its rate.
    half_rate, w, _ = np.polyfit(t, phase, 2)
    speeds, system = (w, 2.0 * half_rate), model.system.at_speed(time.mean()) if model.mass_used > 0.0 else None
    line = solution[0] - 1j * solution[1]
    value, change = _steady(system, speeds, line, (solution[2] - 1j * solution[3]) / span, 0.0 * line)
    curved = curve[0] - 1j * curve[1]
    rate, bend = ((curve[k] - 1j * curve[k + 1]) / scale for k, scale in ((2, span), (9, 0.5 * span**2)))
    more, _ = _steady(system, speeds, curved, rate, bend)
    left_over = (signals - basis @ solution)[:, 6:8]
    size = np.linalg.norm(line[6:8]) * np.sqrt(0.5 * len(t))
    residual = float(np.linalg.norm(left_over) / size) if size > 0.0 else None
    error = abs(more - value) / abs(value) + change**2 if abs(value) > 0.0 else np.inf
    return _Window(float(w), line, value, float(error), residual)


def _steady(
    system: Ring | None, speeds: tuple[float, float], line: np.ndarray, rate: np.ndarray, bend: np.ndarray
) -> tuple[complex, float]:
    """Z [N/m] less the forces of a changing motion, of 1x vectors (10,) of force and motion A with A', A''; and their share.

    system : None where nothing has inertia;  speeds : w [rad/s] and w' [rad/s2]
    """
    import numpy as np

    from raceway.core.signals import steady_stiffness

    if system is None:
        return steady_stiffness(line[:5], line[5:], np.zeros(5, dtype=complex)), 0.0
    w, faster = speeds
    change = system.mass @ (2j * w * rate[5:] + 1j * faster * line[5:] + bend[5:]) + system.damping @ rate[5:]
    power = np.linalg.norm(line[:3])
    return steady_stiffness(line[:5], line[5:], change), float(np.linalg.norm(change[:3]) / power) if power > 0.0 else 0.0
