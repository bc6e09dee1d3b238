"""The 1x line of a Fourier transform over whole turns."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.plugins.identifiers.whole_turns import whole_turns

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.signals.identification import Identification
    from raceway.core.stepping.record import Record


@attrs.frozen
class Fft1x:
    """Detrended 1x line of force and displacement over all whole turns; its spread over single turns is reported."""

    name: ClassVar[str] = "fft_1x"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period"})
    definition: ClassVar[str] = (
        "secant: 1x force over 1x displacement in the direction of the force, Fourier line over whole turns"
    )

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        import numpy as np

        from raceway.core.signals.identification import fit_lines, fourier_line, identification, stiffness, without_drift

        record, frequency = whole_turns(records[0]), model.excitation.frequency_hz
        force = fourier_line(record.time, record.force, frequency)
        line = fourier_line(record.time, record.displacement, frequency)
        whole = stiffness(force, line)
        other, _ = fit_lines(record.time, np.hstack([record.force, record.displacement]), frequency, 3)
        per_turn = record.schedule.steps_per_turn // record.schedule.stride
        turns = len(record.time) // per_turn
        single = []
        if turns > 1:
            force_straight = without_drift(record.time, record.force, frequency)
            straight = without_drift(record.time, record.displacement, frequency)
        for turn in range(turns if turns > 1 else 0):
            part = slice(turn * per_turn, (turn + 1) * per_turn)
            force_1 = fourier_line(record.time[part], force_straight[part], frequency)
            single.append(stiffness(force_1, fourier_line(record.time[part], straight[part], frequency)))
        motion = record.displacement[:, :3] - record.displacement[:, :3].mean(axis=0)
        wt = 2.0 * np.pi * frequency * record.time[:, None]
        pure = (line[:3] * np.exp(1j * wt)).real
        scale = np.sqrt((pure**2).sum())
        return identification(
            self.definition, frequency, force, line, model.mass_used,
            residual=float(np.sqrt(((motion - pure)[:, 1:] ** 2).sum()) / scale) if scale > 0 else None,
            spread=float(max(abs(z - whole) for z in single) / abs(whole)) if single else None,
            window=float(abs(stiffness(other[0, :5], other[0, 5:]) - whole) / abs(whole)),
        )  # fmt: skip
