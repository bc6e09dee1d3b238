from typing import ClassVar

import attrs

from raceway import at_least, hookimpl, option
from raceway.extend import Unidirectional


@attrs.frozen(kw_only=True)
class Pulled(Unidirectional):
    """A harmonic force with an offset that a constant amplitude does not have."""

    name: ClassVar[str] = "pulled"
    offset: float = option(0.0, unit="N", help="added to the unbalance force", rule=at_least(0.0))

    def unused_options(self):
        unused = super().unused_options()
        if self.amplitude == "constant" and self.offset:
            unused["offset"] = "amplitude = 'constant' has no offset"
        return unused

    @property
    def amplitude_n(self):
        return super().amplitude_n + (self.offset if self.amplitude == "unbalance" else 0.0)


@hookimpl
def raceway_excitations():
    return [Pulled]
