"""The linearised answer: the tangent stiffness of the static equilibrium."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.signals.identification import Identification
    from raceway.core.stepping.record import Record


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
        import numpy as np

        from raceway.core.signals.identification import identification

        system, excitation = model.system, model.excitation
        w = 2.0 * np.pi * excitation.frequency_hz
        samples = 64
        force = np.zeros(5, dtype=complex)
        for k in range(samples):
            phase = np.exp(-2j * np.pi * k / samples)
            force += 2.0 / samples * phase * system.outer_force(k / samples / excitation.frequency_hz)
        chosen = system.free > 0.0
        viscous = system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, w)
        dynamic = equilibrium.stiffness_rows_held + viscous + system.stiffness - w**2 * system.mass + 1j * w * system.damping
        line = np.zeros(5, dtype=complex)
        line[chosen] = np.linalg.solve(dynamic[np.ix_(chosen, chosen)], force[chosen])
        return identification(self.definition, excitation.frequency_hz, force, line, model.system.mass[1, 1])
