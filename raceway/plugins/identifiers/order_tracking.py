"""The 1x line along a changing speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.options import between, option

if TYPE_CHECKING:
    from raceway.core.identification import Identification
    from raceway.core.record import Record


@attrs.frozen
class OrderTracking:
    """Least squares of the 1x line in windows of a few turns of the excitation's own phase; a series over speed.

    Notes
    -----
    Within a window the amplitude may change linearly; the line is taken at its middle.
    """

    name: ClassVar[str] = "order_tracking"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "phase"})
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, order tracked over a changing speed"
    )

    window_turns: float = option(6.0, help="turns in a window", rule=between(2.0, 1000.0))

    def identify(self, records: list[Record], equilibrium: Any, model: Any) -> Identification:
        import numpy as np

        from raceway.core.identification import identification, stiffness
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
            p, t = phase[chosen], record.time[chosen]
            u = (t - t.mean()) / (t[-1] - t[0])
            c, s = np.cos(p), np.sin(p)
            basis = np.column_stack([np.ones_like(u), u, c, s, u * c, u * s, np.cos(2 * p), np.sin(2 * p)])
            solution, *_ = np.linalg.lstsq(basis, signals[chosen], rcond=None)
            line = solution[2] - 1j * solution[3]
            rest = (signals[chosen] - basis @ solution)[:, 6:8]
            speed = float((p[-1] - p[0]) / (t[-1] - t[0]))
            series.append((speed, stiffness(line[:5], line[5:])))
            size = np.linalg.norm(line[6:8]) * np.sqrt(0.5 * len(chosen))
            last = (speed, line, float(np.linalg.norm(rest) / size) if size > 0.0 else None)
        if last is None:
            raise ConvergenceError(
                f"the record holds less than {self.window_turns:g} turns: shorten identifier.window_turns"
            )
        speed, line, residual = last
        return identification(
            self.definition, speed / (2.0 * np.pi), line[:5], line[5:], model.mass_used,
            residual=residual, series=tuple(series),
        )  # fmt: skip
