from typing import ClassVar

import attrs
import numpy as np

from raceway import hookimpl


@attrs.frozen
class ThreeHarmonics:
    """Least squares of mean, drift and three harmonics."""

    name: ClassVar[str] = "three_harmonics"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period"})
    definition: ClassVar[str] = "secant: 1x force over 1x displacement in the direction of the force"

    def identify(self, records, equilibrium, model):
        from raceway.extend import fit_harmonics, identification

        record, frequency = records[0], model.excitation.frequency_hz
        lines, _ = fit_harmonics(record.time, np.hstack([record.force, record.displacement]), frequency, 3)
        return identification(self.definition, frequency, lines[0, :5], lines[0, 5:], model.mass_used)


@hookimpl
def raceway_identifiers():
    return [ThreeHarmonics]
