"""The 1x line along a changing speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.options import between, option

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.identification import Identification
    from raceway.core.record import Record


@attrs.frozen
class OrderTracking:
    """Least squares of the 1x line in windows of a few turns of the excitation's own phase; a series over speed.

    Notes
    -----
    Samples have Hann's weights.  Within a window the complex amplitude A may change linearly in time; the line is taken at its
    middle.  While speed and amplitude change, M q'' of q = Re A e^{j phase} is M (-w^2 A + 2 j w A' + j w' A), and of a known
    damping C that is C (j w A + A'): what is beyond the steady terms would be told as damping m (w' + 2 w A' / A) / w and is
    subtracted.  A curvature of A would let more noise in than it takes error out.
    """

    name: ClassVar[str] = "order_tracking"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "phase"})
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, order tracked over a changing speed, less the "
        "inertia of that change"
    )

    window_turns: float = option(6.0, help="turns in a window", rule=between(2.0, 1000.0))

    def identify(self, records: list[Record], equilibrium: Any, model: Any) -> Identification:
        import numpy as np

        from raceway.core.identification import identification
        from raceway.errors import ConvergenceError

        record = records[0]
        phase = model.excitation.phase(record.time)
        signals = np.hstack([record.force, record.displacement])
        width = 2.0 * np.pi * self.window_turns
        series, last = [], None
        first = phase[0]
        # A sample stands for the step that ends with it: n turns are n turns less one step from first to last sample.
        end = phase[-1] + 1.01 * (phase[-1] - phase[-2])
        while first + width <= end:
            chosen = np.flatnonzero((phase >= first) & (phase < first + width))
            first += 0.5 * width
            if len(chosen) < 24:
                continue
            speed, line, value, residual = _window(model, record.time[chosen], phase[chosen], signals[chosen])
            series.append((speed, value))
            last = (speed, line, residual)
        if last is None:
            raise ConvergenceError(
                f"the record holds less than {self.window_turns:g} turns: shorten identifier.window_turns"
            )
        speed, line, residual = last
        found = identification(
            self.definition, speed / (2.0 * np.pi), line[:5], line[5:], model.mass_used,
            residual=residual, series=tuple(series),
        )  # fmt: skip
        return attrs.evolve(found, dynamic_stiffness=series[-1][1])


def _window(
    model: Any, time: np.ndarray, phase: np.ndarray, signals: np.ndarray
) -> tuple[float, np.ndarray, complex, float | None]:
    """Speed [rad/s], 1x line (10,), Z [N/m] at the middle of a window, and what is left over the line."""
    import numpy as np

    from raceway.core.identification import steady_stiffness

    t = time - time.mean()
    u = t / (t[-1] - t[0])
    c, s = np.cos(phase), np.sin(phase)
    basis = np.column_stack([c, s, u * c, u * s, np.ones_like(u), u, u * u, np.cos(2 * phase), np.sin(2 * phase)])
    # Hann's weights: a free vibration leaks less into the line by orders of magnitude.
    weight = np.sqrt(1.0 - np.cos(2.0 * np.pi * (np.arange(len(t)) + 0.5) / len(t)))[:, None]
    solution, *_ = np.linalg.lstsq(weight * basis, weight * signals, rcond=None)
    line, rate = (solution[k] - 1j * solution[k + 1] for k in (0, 2))
    rate = rate / (t[-1] - t[0])
    # Of the phase: w at the middle, and its rate.
    half_rate, w, _ = np.polyfit(t, phase, 2)
    inertia = np.zeros(5, dtype=complex)
    if model.mass_used > 0.0:
        moved, system = line[5:], model.system.at_speed(time.mean())
        inertia = system.mass @ (2j * w * rate[5:] + 2j * half_rate * moved) + system.damping @ rate[5:]
    rest = (signals - basis @ solution)[:, 6:8]
    size = np.linalg.norm(line[6:8]) * np.sqrt(0.5 * len(t))
    residual = float(np.linalg.norm(rest) / size) if size > 0.0 else None
    return float(w), line, steady_stiffness(line[:5], line[5:], inertia), residual
