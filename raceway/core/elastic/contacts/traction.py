"""Duties of friction at the places of a contact."""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Friction(Protocol):
    """Tangential traction at the points.

    1. ``evaluate(moved, normal, pressure, d_gap)``: moved (n, 3), displacement of the points against the other surface
       [m]; traction (n, 3) on the points [Pa] and minus its derivative by ``moved`` (n, 3, 3) [Pa/m].
    2. ``commit()``, ``rollback()``: as for the system;  ``dissipated``: density (n,) [J/m2] up to the last commit;
       ``stored()``: density (n,) in what sticks.
    3. ``begin(moved)``: nothing carries or has lost anything there.  ``state()``: arrays by name that ``restore(arrays)`` takes back.
    """

    dissipated: np.ndarray

    def evaluate(
        self, moved: np.ndarray, normal: np.ndarray, pressure: np.ndarray, d_gap: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def stored(self) -> np.ndarray: ...
    def begin(self, moved: np.ndarray) -> None: ...
    def commit(self) -> None: ...
    def rollback(self) -> None: ...
    def state(self) -> dict[str, np.ndarray]: ...
    def restore(self, arrays: dict[str, np.ndarray]) -> None: ...
