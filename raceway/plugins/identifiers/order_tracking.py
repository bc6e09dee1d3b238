"""Dynamic stiffness along a changing speed, by order tracking."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import ConvergenceError
from raceway.framework.options import between, option

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.record import Record
    from raceway.core.ring.ring import Ring
    from raceway.core.signals import Identification
    from raceway.framework.contracts import Equilibrium, Model


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
        "secant: 1x force over 1x displacement in the direction of the force, order tracked over a changing speed, less the "
        "inertia of that change"
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
            raise ConvergenceError(
                f"the record holds less than {self.window_turns:g} turns: shorten identifier.window_turns"
            )
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

    t = time - time.mean()
    span = t[-1] - t[0]
    u = t / span
    c, s = np.cos(phase), np.sin(phase)
    basis = np.column_stack([c, s, u * c, u * s, np.ones_like(u), u, u * u, np.cos(2 * phase), np.sin(2 * phase)])
    bent = np.column_stack([basis, u * u * c, u * u * s])
    # Hann's weights: a free vibration leaks less into the line by orders of magnitude.
    weight = np.sqrt(1.0 - np.cos(2.0 * np.pi * (np.arange(len(t)) + 0.5) / len(t)))[:, None]
    solution, curve = (np.linalg.lstsq(weight * columns, weight * signals, rcond=None)[0] for columns in (basis, bent))
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
