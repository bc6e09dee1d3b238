"""Two-frequency force for Raceway."""

from __future__ import annotations

from raceway import hookimpl
from raceway_two_frequency.excitation import TwoFrequency


@hookimpl
def raceway_excitations() -> list[type]:
    return [TwoFrequency]
