"""Numbers that may be columns: one number, or an array (n,) with that of each of n operating points.

A function of numbers is then one of columns, if it takes its elementary functions from here and branches on what all points share.
A number alone goes through ``math``, as ever.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

import attrs

T = TypeVar("T", bound=attrs.AttrsInstance)
#: A number, or a column of them.
Number = Any


def is_column(value: object) -> bool:
    """Whether a number is one of each point."""
    return bool(getattr(value, "ndim", 0))


def _either(number: Callable[..., float], column: str) -> Callable[..., Any]:
    """A function of numbers, numpy's of that name where any of them is a column."""

    def function(*values: Number) -> Number:
        if not any(map(is_column, values)):
            return number(*values)
        import numpy

        return getattr(numpy, column)(*values)

    return function


cos, sin = _either(math.cos, "cos"), _either(math.sin, "sin")
acos, asin = _either(math.acos, "arccos"), _either(math.asin, "arcsin")
sqrt, log, radians = _either(math.sqrt, "sqrt"), _either(math.log, "log"), _either(math.radians, "radians")
least, largest = _either(min, "minimum"), _either(max, "maximum")
#: Whether a number is not 0, of a column any.
some = _either(bool, "any")
#: The second where the first is true, else the third.
where = _either(lambda condition, value, other: value if condition else other, "where")


def _values(part: attrs.AttrsInstance) -> dict[str, Any]:
    """What stands in a table, by the names of its keys."""
    return {field.name: getattr(part, field.name) for field in attrs.fields(type(part))}


def has_columns(part: attrs.AttrsInstance) -> bool:
    """Whether any number of a table, or of a table in it, is a column."""
    return length(part) > 0


def with_values(part: T, **changes: object) -> T:
    """A copy of a table with other values, which no rule of the table looks at: columns obey them point by point."""
    kind: Any = type(part)
    copy = object.__new__(kind)
    for name, value in (_values(part) | changes).items():
        object.__setattr__(copy, name, value)
    return copy


def per_ball(value: Number) -> Number:
    """A number, or a column as (n, 1), to be spread over balls."""
    return value[:, None] if is_column(value) else value


def at_row(part: T, row: int) -> T:
    """A table with the numbers of one point."""
    values = _values(part)
    numbers = {name: float(value[row]) for name, value in values.items() if is_column(value)}
    tables = {name: at_row(value, row) for name, value in values.items() if attrs.has(type(value)) and has_columns(value)}
    return with_values(part, **numbers, **tables)


def length(part: attrs.AttrsInstance) -> int:
    """Points of a table that has columns, or tables with them; 0 of one that has none."""
    values = _values(part).values()
    sizes = (len(value) if is_column(value) else length(value) if attrs.has(type(value)) else 0 for value in values)
    return next((size for size in sizes if size), 0)
