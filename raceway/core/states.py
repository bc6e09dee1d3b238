"""Shapes of the states that are handed to compiled kernels, which look at none: they would write beyond the arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from raceway.core.record import Motion
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
    balls = system.ball_count, system.ball_columns
    for name, values in arrays.items():
        wanted = (5,) if name in ("q", "v", "a", "rest") else system.law_state.shape if name == "memory" else balls
        found = np.shape(values) if values is not None else wanted
        if found != wanted:
            rows = (
                "a row for each ball"
                if wanted is balls
                else "a row for each contact"
                if name == "memory"
                else "x, y, z, tilts"
            )
            raise PluginError(f"{who}: `{name}` has the shape {found}; that of this system is {wanted}: {rows}")
