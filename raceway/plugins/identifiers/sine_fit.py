"""Least squares of mean, drift and a few harmonics: for windows that are not whole turns, too."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import between, option

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.signals.identification import Identification
    from raceway.core.stepping.record import Record


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
        import numpy as np

        from raceway.core.signals.identification import fit_lines, fourier_line, identification, stiffness, without_drift

        record, frequency = records[0], model.excitation.frequency_hz
        signals = np.hstack([record.force, record.displacement])
        lines, rest = fit_lines(record.time, signals, frequency, self.harmonics)
        force, line = lines[0, :5], lines[0, 5:]
        whole = stiffness(force, line)
        per_turn = record.schedule.steps_per_turn // record.schedule.stride
        straight = without_drift(record.time, signals, frequency)
        single = []
        for turn in range(len(record.time) // per_turn):
            part = slice(turn * per_turn, (turn + 1) * per_turn)
            one, _ = fit_lines(record.time[part], straight[part], frequency, self.harmonics)
            single.append(stiffness(one[0, :5], one[0, 5:]))
        scale = np.linalg.norm(line[1:3]) * np.sqrt(0.5 * len(record.time))
        other = stiffness(
            fourier_line(record.time, record.force, frequency), fourier_line(record.time, record.displacement, frequency)
        )
        return identification(
            self.definition, frequency, force, line, model.mass_used,
            residual=float(np.linalg.norm(rest[:, 6:8]) / scale) if scale > 0 else None,
            spread=float(max(abs(z - whole) for z in single) / abs(whole)) if len(single) > 1 else None,
            window=float(abs(other - whole) / abs(whole)),
        )  # fmt: skip
