"""Numbers that may be columns: one number, or an array (n,) with that of each of n operating points; interpolation between few.

A function of numbers is then one of columns, if it takes its elementary functions from here and branches on what all points share.
A number alone goes through ``math``, as ever.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

import attrs

if TYPE_CHECKING:
    import numpy as np

T = TypeVar("T", bound=attrs.AttrsInstance)
#: A number, or a column of them.
Number = Any
#: Whether a type is that of tables.
is_table: Callable[[type], bool] = cache(attrs.has)
#: Names of the keys of a table's type; types that are no columns and have none.
_names: Callable[[type], tuple[str, ...]] = cache(lambda kind: tuple(field.name for field in attrs.fields(kind)))
_PLAIN = {float, int, str, bool, type(None)}


def is_column(value: object) -> bool:
    """Whether a number is one of each point."""
    return bool(getattr(value, "ndim", 0))


def _either(number: Callable[..., float], column: str) -> Callable[..., Any]:
    """A function of numbers, numpy's of that name where any of them is a column."""

    def function(*values: Number) -> Number:
        if all(type(value) is float or not is_column(value) for value in values):
            return number(*values)
        import numpy

        return getattr(numpy, column)(*values)

    return function


cos, sin = _either(math.cos, "cos"), _either(math.sin, "sin")
acos, asin = _either(math.acos, "arccos"), _either(math.asin, "arcsin")
sqrt, log, log10 = _either(math.sqrt, "sqrt"), _either(math.log, "log"), _either(math.log10, "log10")
radians = _either(math.radians, "radians")
least, largest = _either(min, "minimum"), _either(max, "maximum")
#: Whether a number is not 0, of a column any.
some = _either(bool, "any")
#: The second where the first is true, else the third.
where = _either(lambda condition, value, other: value if condition else other, "where")


def elliptic_integrals(m1: Number) -> tuple[Number, Number]:
    """Complete elliptic integrals K and E of the parameter m = 1 - m1 by the arithmetic-geometric mean (Abramowitz, Stegun, 17.6)."""
    a, b, ratio = 1.0, sqrt(m1), 0.5 * (1.0 + m1)
    for k in range(13):  # makes two numbers one to rounding, for any ellipse
        ratio = ratio - 2.0 ** (k - 2) * (a - b) ** 2
        a, b = 0.5 * (a + b), sqrt(a * b)
    return 0.5 * math.pi / a, 0.5 * math.pi / a * ratio


def _column_values(part: attrs.AttrsInstance) -> dict[str, Any]:
    return {name: getattr(part, name) for name in _names(type(part))}


def has_columns(part: attrs.AttrsInstance) -> bool:
    """Whether any number of a table, or of a table in it, is a column."""
    return length(part) > 0


def with_values(part: T, **changes: object) -> T:
    """A copy of a table with other values, which no rule of the table looks at: columns obey them point by point."""
    kind: Any = type(part)
    copy = object.__new__(kind)
    for name, value in (_column_values(part) | changes).items():
        object.__setattr__(copy, name, value)
    return copy


def per_ball(value: Number) -> Number:
    """A number, or a column as (n, 1), to be spread over balls."""
    return value[:, None] if is_column(value) else value


def at_row(part: T, row: int) -> T:
    """A table with the numbers of one point."""
    return _selected(part, lambda column: float(column[row]))


def at_rows(part: T, rows: np.ndarray) -> T:
    """A table with the columns (m,) of some of the points, by their indices (m,), which may repeat."""
    return _selected(part, lambda column: column[rows])


def _selected(part: T, choose: Callable[[np.ndarray], object]) -> T:
    if not has_columns(part):
        return part
    values = _column_values(part)
    numbers = {name: choose(value) for name, value in values.items() if is_column(value)}
    tables = {name: _selected(value, choose) for name, value in values.items() if is_table(type(value))}
    return with_values(part, **numbers, **tables)


def distinct(part: T) -> tuple[list[T], np.ndarray]:
    """Tables with each distinct set of numbers of a table's columns, and the index (n,) of each point's; rules look at them."""
    import numpy as np

    columns = {name: value for name, value in _column_values(part).items() if is_column(value)}
    numbers, index = np.unique(np.stack(list(columns.values()), axis=1), axis=0, return_inverse=True)
    kind, fixed = type(part), {field.alias: getattr(part, field.name) for field in attrs.fields(type(part)) if field.init}
    return [kind(**fixed | dict(zip(columns, row, strict=True))) for row in numbers.tolist()], index.ravel()


def length(part: attrs.AttrsInstance) -> int:
    """Points of a table that has columns, or tables with them; 0 of one that has none."""
    for name in _names(type(part)):
        value = getattr(part, name)
        if type(value) not in _PLAIN and (
            size := len(value) if is_column(value) else length(value) if is_table(type(value)) else 0
        ):
            return size
    return 0


#: Nodes of each variable, tried in turn, and points at which the interpolation is compared with the function.
_NODES, _COMPARED = (3, 5, 9), 8


def interpolated(function: Callable[[np.ndarray], np.ndarray], points: np.ndarray, tolerance: float) -> np.ndarray:
    """Values (n,) of a function at points (k, n), exact or within a relative tolerance at some of them.

    function : of points (k, m), its values (m,), not zero

    Interpolation on the product of Chebyshev nodes of the variables that differ, as long as these are fewer than half of the points.

    Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 8.
    """
    import numpy as np
    from numpy.polynomial.chebyshev import chebvander

    places, index = np.unique(points, axis=1, return_inverse=True)
    low, high = places.min(axis=1), places.max(axis=1)
    varied, count = np.flatnonzero(high > low), places.shape[1]
    middle, half = 0.5 * (low + high)[varied, None], 0.5 * (high - low)[varied, None]
    some = np.unique(np.linspace(0, count - 1, _COMPARED).astype(int))
    for nodes in _NODES:
        if 2 * nodes ** len(varied) > count:
            break
        t = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
        grid = np.repeat(places[:, :1], nodes ** len(varied), axis=1)
        grid[varied] = np.stack(np.meshgrid(*(middle + half * t), indexing="ij")).reshape(len(varied), -1)
        values, transform = function(grid).reshape([nodes] * len(varied)), np.linalg.inv(chebvander(t, nodes - 1))
        for axis in range(len(varied)):
            values = np.moveaxis(np.tensordot(transform, values, (1, axis)), 0, axis)
        total = np.broadcast_to(values, (count, *values.shape))
        for x in (places[varied] - middle) / half:
            total = np.einsum("nj...,nj->n...", total, chebvander(x, nodes - 1))
        if np.allclose(total[some], function(places[:, some]), rtol=tolerance, atol=0.0):
            return total[index.ravel()]
    return function(places)[index.ravel()]
