"""One driver of a scheme by itself."""

from __future__ import annotations

from typing import Any

import attrs

from raceway.core.schemes.drivers import Drivers


@attrs.frozen
class FromPython:
    """An integrator without its compiled driver: the same steps, one by one from Python."""

    method: Any

    @property
    def scheme(self) -> Drivers:
        return Drivers(stepped=self.method.scheme.stepped)


def has_both(method: Any) -> bool:
    """Whether a scheme has a compiled and a stepped driver."""
    return method.scheme.compiled is not None and method.scheme.stepped is not None
