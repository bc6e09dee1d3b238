"""Derivatives of quantities by keys: differences of columns of one computation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

import numpy as np

#: Values by the names of outputs.
Columns: TypeAlias = dict[str, np.ndarray]

#: Relative step of differences, of fourth order.
_STEP = 1e-3
#: Weights of values at shifts by so many steps: their sum over the step is the derivative.
_CENTRAL = {-2: 1.0 / 12.0, -1: -8.0 / 12.0, 1: 8.0 / 12.0, 2: -1.0 / 12.0}
_FORWARD = {0: -25.0 / 12.0, 1: 4.0, 2: -3.0, 3: 4.0 / 3.0, 4: -0.25}
_BACKWARD = {-shift: -weight for shift, weight in _FORWARD.items()}
#: What numbers that are 0 are taken for in such a step, by their units; 1 otherwise.
_LEAST = {"m": 1e-6}


def jacobian(
    columns: Callable[[Columns], Columns],
    allowed: Callable[[str, float], bool],
    inputs: Columns,
    units: Mapping[str, str],
    outputs: Sequence[str],
) -> dict[str, Columns]:
    """Derivatives (n, ...) of each output by each input that has a unit: ``jacobian(...)[output][input]``.

    Parameters
    ----------
    columns : computes outputs from columns of all inputs;  allowed : whether a key's rule admits a number
    inputs : (n,) each, by their keys;  units : of those by which is derived
    """
    stencils, steps = {}, {}
    for key, unit in units.items():
        least, finite = _LEAST.get(unit, 1.0), np.isfinite(inputs[key])
        # What is no number has no derivative, and no say in the steps of the others.
        value = np.where(finite, inputs[key], inputs[key][finite][0] if finite.any() else least)
        size = np.abs(value)
        steps[key] = _STEP * np.where(size > 0.0, size, size.max() or least)
        low, high = (
            allowed(key, float(end)) for end in ((value - 2.0 * steps[key]).min(), (value + 2.0 * steps[key]).max())
        )
        stencils[key] = _FORWARD if not low else _CENTRAL if high else _BACKWARD
    # All inputs at all shifts of one key after another.
    moves = [(path, shift * steps[path]) for path, stencil in stencils.items() for shift in stencil]
    neighbours = {
        key: np.concatenate([value + move * (path == key) for path, move in moves]) for key, value in inputs.items()
    }
    answer, out = columns(neighbours), dict[str, Columns]()
    for name in outputs:
        parts, first = answer[name].reshape((-1, len(size), *answer[name].shape[1:])), 0
        out[name] = {}
        for key, stencil in stencils.items():
            slope = np.tensordot(list(stencil.values()), parts[first : first + len(stencil)], axes=1)
            out[name][key] = (slope.T / steps[key]).T
            first += len(stencil)
    return out
