"""What a format leaves out of a bearing's coefficients, in sentences with its size; sentences as comments of a file."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

import numpy as np

from raceway.studies.ross.coefficients import Coefficients

LINEAR = "linear: that the stiffness depends on the amplitude is left out"
#: Parts of the largest entry of its kind below which an entry is rounding.
ROUNDING = 1e-9
#: Characters of a comment's line: bulk data has no more.
_WIDTH = 72


def comments(sentences: Iterable[str], sign: str) -> list[str]:
    """Lines of ASCII, which is all that old readers take."""
    plain = (one.replace("µ", "u").encode("ascii", "replace").decode() for one in sentences)
    return [line for one in plain for line in textwrap.wrap(one, _WIDTH, initial_indent=sign, subsequent_indent=f"{sign}  ")]


def cross_terms(table: Coefficients) -> str:
    """Of the directions across the axis; empty where there are none."""
    found = []
    for letter, matrix in (("k", table.stiffness), ("c", table.damping)):
        along = np.sqrt(np.abs(matrix[..., 0, 0] * matrix[..., 1, 1]))
        across = np.maximum(np.abs(matrix[..., 0, 1]), np.abs(matrix[..., 1, 0]))
        share = float(np.max(across / np.where(along > 0.0, along, 1.0)))
        if share > ROUNDING and along.any():
            found.append(f"{letter}yz, {letter}zy (up to {share:.2g} of the diagonal)")
    return f"left out: {' and '.join(found)}" if found else ""


def tilt_coupling(table: Coefficients) -> str:
    """Forces that a tilt makes, beside a diagonal with the tilt held; empty where there are none."""
    matrix = table.tangent
    if not matrix.any():
        return ""
    size = np.sqrt(np.abs(np.einsum("...ii->...i", matrix)))
    share = np.abs(matrix[..., :3, 3:]) / (size[..., :3, None] * size[..., None, 3:])
    largest = float(np.max(share))
    return (
        f"left out: the forces that a tilt makes, and the moments of a displacement, up to {largest:.2g} of the geometric mean of "
        "their diagonal entries"
        if largest > ROUNDING
        else ""
    )
