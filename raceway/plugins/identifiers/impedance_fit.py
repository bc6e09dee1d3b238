"""K, m and C from the dynamic stiffness at several speeds."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.options import option, worded
from raceway.plugins.identifiers.whole_turns import whole_turns

if TYPE_CHECKING:
    from raceway.core.identification import Identification
    from raceway.core.record import Record


def _speeds(_instance: Any, _attribute: Any, value: tuple[float, ...]) -> None:
    if len(set(value)) < 2 or min(value) <= 0.0:
        raise ValueError("must be a list of at least two different speeds greater than 0")


@attrs.frozen
class ImpedanceFit:
    """Z(w) = K - m w^2 + j w C fitted by least squares to 1x lines at ``speeds_rpm``; nothing is assumed about the mass."""

    name: ClassVar[str] = "impedance_fit"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period", "speeds"})
    definition: ClassVar[str] = "secant: K, m and C of Z = K - m w^2 + j w C by least squares over several speeds"

    speeds_rpm: tuple[float, ...] = option(
        unit="r/min",
        help="speeds that are run, at least two",
        rule=worded(_speeds, "at least two different speeds greater than 0"),
    )

    @classmethod
    def examples(cls) -> list[ImpedanceFit]:
        """Instances for the conformance suite."""
        return [cls(speeds_rpm=(7200.0, 9600.0, 12000.0, 14400.0, 16800.0))]

    def identify(self, records: list[Record], equilibrium: Any, model: Any) -> Identification:
        import numpy as np

        from raceway.core.identification import fourier_line, identification, stiffness

        records = [whole_turns(record) for record in records]
        w = np.array([2.0 * pi / (r.schedule.dt * r.schedule.steps_per_turn) for r in records])
        lines = [
            (fourier_line(r.time, r.force, s / (2.0 * pi)), fourier_line(r.time, r.displacement, s / (2.0 * pi)))
            for r, s in zip(records, w, strict=True)
        ]
        z = np.array([stiffness(force, line) for force, line in lines])
        # The columns are scaled to like size: K is some 1e8, m w^2 some 1e6.
        scale = float(np.mean(w**2))
        (k, m), *_ = np.linalg.lstsq(np.column_stack([np.ones_like(w), -(w**2) / scale]), z.real, rcond=None)
        mass, damping = float(m / scale), float((w @ z.imag) / (w @ w))
        fitted = k - mass * w**2 + 1j * w * damping
        own = 2.0 * pi * model.excitation.frequency_hz
        nearest = int(np.argmin(np.abs(w - own)))
        found = identification(self.definition, own / (2.0 * pi), *lines[nearest], mass_used=mass)
        return attrs.evolve(
            found,
            dynamic_stiffness=complex(k - mass * own**2, own * damping),
            residual=float(np.sqrt(np.mean(np.abs(z - fitted) ** 2)) / abs(z).mean()),
            series=tuple((float(s), complex(one)) for s, one in zip(w, z, strict=True)),
        )
