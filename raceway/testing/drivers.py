"""One driver of a scheme by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

from raceway.core.schemes.drivers import Drivers

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator


@attrs.frozen
class FromPython:
    """An integrator without its compiled driver: the same steps, one by one from Python."""

    method: Integrator

    @property
    def scheme(self) -> Drivers:
        return Drivers(stepped=self.method.scheme.stepped)


def has_both(method: Integrator) -> bool:
    """Whether a scheme has a compiled and a stepped driver."""
    return method.scheme.compiled is not None and method.scheme.stepped is not None
