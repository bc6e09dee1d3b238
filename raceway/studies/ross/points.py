"""Coefficients as rows: the points of a table for ROSS, and what is the same at all of them."""

from __future__ import annotations

import numpy as np

from raceway.storage.tables import ReadTables

#: Cross terms of an isotropic bearing, and changes along an axis, below this part of the largest of their kind are rounding.
_ROUNDING = 1e-9
_SHOWN = "{:.5g}"


def point_rows(content: ReadTables) -> tuple[list[dict[str, str]], list[str]]:
    """One row a point of a table over one axis, the ends of a table over two, by name and unit; sentences on what does not vary."""
    axes = {name: 30.0 / np.pi * np.array(content[name]) for name in ("speed", "frequency") if content[name] is not None}
    columns = {name: np.array(values) for name, values in content["coefficients"].items()}
    largest = {letter: max(float(np.max(np.abs(v))) for n, v in columns.items() if n[0] == letter) for letter in "kc"}
    shown = {name: v for name, v in columns.items() if np.max(np.abs(v)) > _ROUNDING * largest[name[0]]}
    groups = _alike(shown)
    constant = [
        f"{_joined(names)} = {_text(name, values.flat[0])} {_unit(name)} at all points"
        for name, names, values in groups
        if np.ptp(values) <= _ROUNDING * largest[name[0]]
    ]
    varying = [(name, names, values) for name, names, values in groups if np.ptp(values) > _ROUNDING * largest[name[0]]]
    rows = []
    shape = tuple(len(values) for values in axes.values())
    for place in np.ndindex(shape):
        if len(shape) == 2 and any(0 < k < size - 1 for k, size in zip(place, shape, strict=True)):
            continue
        row = {f"{name}\nr/min": f"{values[k]:.6g}" for (name, values), k in zip(axes.items(), place, strict=True)}
        for name, names, values in varying:
            row[f"{_joined(names)}\n{_unit(name)}"] = _text(name, float(values[place]))
        rows.append(row)
    zero = [name for name in columns if name not in shown]
    return rows, [*constant, *([f"0 at all points: {', '.join(zero)}"] if zero else [])]


def _alike(columns: dict[str, np.ndarray]) -> list[tuple[str, list[str], np.ndarray]]:
    """First name, all names and values of columns that have the same text everywhere."""
    found: list[tuple[str, list[str], np.ndarray]] = []
    for name, values in columns.items():
        texts = [_text(name, float(v)) for v in values.flat]
        for other, names, known in found:
            if other[0] == name[0] and texts == [_text(other, float(v)) for v in known.flat]:
                names.append(name)
                break
        else:
            found.append((name, [name], values))
    return found


def _joined(names: list[str]) -> str:
    """kyy = kzz; what all names end with stands once."""
    return " = ".join(name[:3] for name in names) + names[0][3:].replace("_", " ")


def _unit(name: str) -> str:
    return "N/µm" if name[0] == "k" else "N s/m"


def _text(name: str, value: float) -> str:
    return _SHOWN.format(value * (1e-6 if name[0] == "k" else 1.0))
