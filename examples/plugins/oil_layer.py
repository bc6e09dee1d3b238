from typing import ClassVar

import attrs
import numpy as np

from raceway import hookimpl, option, positive
from raceway.extend import Hertz, LawReport


@attrs.frozen
class OilLayer(Hertz):
    """Hertz behind a layer whose thickness grows with the entraining speed to the power 2/3, at any load."""

    name: ClassVar[str] = "oil_layer"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    renewed: ClassVar[bool] = True
    at_reference: float = option(1e-7, unit="m", help="thickness at the reference speed", rule=positive())
    reference: float = option(1.0, unit="m/s", help="entraining speed of that thickness", rule=positive())

    def reach(self, pairs):
        return self.at_reference * np.cbrt(pairs.entraining_speed / self.reference) ** 2

    def report(self, pairs):
        return LawReport({"layer_m": self.reach(pairs)}, {})


@hookimpl
def raceway_contact_laws():
    return [OilLayer]
