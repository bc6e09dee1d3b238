"""All coefficients as CSV and JSON: the 2x2 matrices, kxx, and the 5x5 matrices of the equilibria."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence

import numpy as np

from raceway.storage.tables import Tables
from raceway.studies.ross.coefficients import Coefficients
from raceway.studies.sweep.variables import DOF


def csv_text(table: Coefficients, head: Sequence[str]) -> str:
    """A line each point; the head's lines begin with #, and the line behind them names the columns and their units."""
    axes = table.axes
    points = np.meshgrid(*axes.values(), indexing="ij")
    columns = {f"{name} [rad/s]": values for name, values in zip(axes, points, strict=True)}
    columns |= {f"{name} [{'N/m' if name[0] == 'k' else 'N s/m'}]": values for name, values in table.columns().items()}
    columns |= dict(_entries("K", table.tangent)) | dict(_entries("C", table.tangent_damping))
    text = io.StringIO()
    text.writelines(f"# {sentence}\n" for sentence in head)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.ravel().tolist() for values in columns.values()), strict=True))
    return text.getvalue()


def json_text(table: Coefficients, head: Sequence[str], tag: str) -> str:
    """The same as one object; the matrices are lists over points, rows and columns."""
    content: Tables = {
        "tag": tag,
        "notes": list(head),
        "source": table.source,
        "definition": table.definition,
        **{name: {"unit": "rad/s", "values": values.tolist()} for name, values in table.axes.items()},
        "coefficients": {
            name: {"unit": "N/m" if name[0] == "k" else "N s/m", "values": values.tolist()}
            for name, values in table.columns().items()
        },
        "coordinates": list(DOF),
        "K": {"unit": [[_unit("K", a, b) for b in DOF] for a in DOF], "values": table.tangent.tolist()},
        "C": {"unit": [[_unit("C", a, b) for b in DOF] for a in DOF], "values": table.tangent_damping.tolist()},
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def numbers_notes() -> list[str]:
    """What the reader of the file has to know."""
    return [
        "SI; coordinates x (the axis), y, z, tilt_y, tilt_z (about y, z) of the bearing",
        "kyy ... czz, kxx: the tilts held, or, by their names, following; x as told; K, C: 5x5 of the contacts at the equilibrium, every other motion held: "
        "small motions, without shaft, rotor and supports",
    ]


def _entries(letter: str, matrix: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    for i, a in enumerate(DOF):
        for j, b in enumerate(DOF):
            yield f"{letter} {a} {b} [{_unit(letter, a, b)}]", matrix[..., i, j]


def _unit(letter: str, row: str, column: str) -> str:
    """Of force or moment over displacement or tilt, or over their rates."""
    force, over = ("N m" if "tilt" in row else "N"), ("rad" if "tilt" in column else "m")
    return f"{force}{' s' if letter == 'C' else ''}/{over}"
