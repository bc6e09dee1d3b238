"""Shapes of the states that are handed to compiled kernels, which look at none: they would write beyond the arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from raceway.core.stepping.record import Motion
from raceway.errors import PluginError


def check_start(system: Any, start: Motion) -> None:
    """Refuse a motion that is none of a system's; see ``check_state``."""
    parts = {name: getattr(start, name) for name in ("q", "v", "a", "rest", "ball", "ball_before", "memory")}
    check_state(system, "the motion that an integration starts from", **parts)


def check_state(system: Any, who: str, **arrays: np.ndarray | None) -> None:
    """Refuse arrays that are not a system's; None is left out.

    Parameters
    ----------
    system : with ``ball_count``, ``ball_columns`` and ``law_state``;  who : whose arrays they are, for the message
    arrays : by name: ``q``, ``v``, ``a``, ``rest`` (5,), ``memory`` as ``law_state``, and any other (Z, columns) of balls

    Raises
    ------
    PluginError
        With the array, its shape, and the system's.
    """
    coordinates = (5,), "x, y, z, tilts"
    known: dict[str, tuple[tuple[int, ...], str]] = dict.fromkeys(("q", "v", "a", "rest"), coordinates)
    known["memory"] = system.law_state.shape, "a row for each contact"
    balls = (system.ball_count, system.ball_columns), "a row for each ball"
    for name, values in arrays.items():
        wanted, rows = known.get(name, balls)
        if values is not None and np.shape(values) != wanted:
            raise PluginError(f"{who}: `{name}` has the shape {np.shape(values)}; that of this system is {wanted}: {rows}")
