"""Rings that are stepped from Python, and the compiled ring near each, which gives first guesses and orbits to start on."""

from __future__ import annotations

import attrs

from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System


@attrs.define(eq=False, kw_only=True)
class SteppedRing(Ring):
    """A ring whose contact forces are not compiled.

    Attributes
    ----------
    rigid : the same ring with rigid bodies and Hertz's contacts
    """

    rigid: System

    @property
    def surrogate(self) -> System:
        """The rigid ring under this one's loads."""
        return attrs.evolve(self.rigid, **{f.name: getattr(self, f.name) for f in attrs.fields(Ring)})


def compiled(ring: Ring) -> System | None:
    """The ring for compiled loops; None where it is stepped from Python."""
    return ring if isinstance(ring, System) else None


def surrogate(ring: Ring) -> System:
    """A compiled ring near this one; itself where it is one."""
    if isinstance(ring, System):
        return ring
    assert isinstance(ring, SteppedRing), "rings are compiled or stepped"
    return ring.surrogate
