"""Readers of exported coefficients, by the fields of their formats alone: bulk data, commands of APDL, CSV.

They know nothing of the writers in packages/raceway-rotor/raceway_rotor/files.py: the tests and the report ``ross`` read the files with them.
"""

import csv
import re

import numpy as np

#: Entry of a matrix -> the names of COMBI214's real constants behind R and RMORE, in the element's order.
COMBI214 = {"11": (0, 0), "22": (1, 1), "12": (0, 1), "21": (1, 0)}
#: Relative rounding of a real number in a field of 16 characters: 10 significant digits.
DIGITS = 5.1e-10


def entries(text: str) -> list[tuple[str, list[str]]]:
    """Bulk data by fixed fields: (name, fields behind the name), continuations joined.  Fields of 8 characters, or of 16
    where the name or the continuation ends with *; the tenth field joins lines and is empty."""
    found: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line.startswith("$"):
            continue
        assert len(line) <= 72, line
        name, rest = line[:8].strip(), line[8:]
        width, count = (16, 4) if name.endswith("*") else (8, 8)
        fields = [rest[k * width : (k + 1) * width].strip() for k in range(count)]
        if name in ("*", "+"):
            found[-1][1].extend(fields)
        else:
            found.append((name.rstrip("*"), fields))
    return found


def tables(found: list[tuple[str, list[str]]]) -> dict[int, np.ndarray]:
    """Number -> x, y (2, n) of each TABLED1: pairs from the ninth field on, up to ENDT."""
    out = {}
    for name, fields in found:
        if name == "TABLED1":
            assert fields[1:8] == [""] * 7  # linear axes
            numbers = [float(one) for one in fields[8 : fields.index("ENDT")]]
            out[int(fields[0])] = np.array(numbers).reshape(-1, 2).T
    return out


def by_direction(fields: list[str]) -> dict[str, list[str]]:
    """Letter -> six fields, of PBUSH and PBUSHT: a letter leads each eight fields, behind the number of the property."""
    return {fields[k + 1]: fields[k + 2 : k + 8] for k in range(0, len(fields), 8) if len(fields) > k + 1 and fields[k + 1]}


def apdl(text: str) -> tuple[dict[str, np.ndarray], list[list[str]]]:
    """Tables by name as (2, n) speeds and values, and the other commands as lists of words."""
    sizes: dict[str, int] = {}
    cells: dict[tuple[str, int, int], float] = {}
    commands = []
    for line in text.splitlines():
        if line.startswith("!"):
            continue
        if given := re.fullmatch(r"(\w+)\((\d+),([01])\)=(.*)", line):
            name, row, column, joined = given.groups()
            values = joined.split(",")
            assert len(values) <= 10  # of one assignment
            for k, value in enumerate(values):
                cells[name, int(row) + k, int(column)] = float(value)
        elif line.startswith("*DIM"):
            _, name, kind, rows, columns, planes, over = line.split(",")
            assert (kind, columns, planes, over) == ("TABLE", "1", "1", "OMEGS")
            sizes[name] = int(rows)
        else:
            commands.append(line.split(","))
    found = {name: np.array([[cells.pop((name, k + 1, c)) for k in range(n)] for c in (0, 1)]) for name, n in sizes.items()}
    assert not cells
    return found, commands


def constants(commands: list[list[str]]) -> list[str]:
    """Real constants behind R and RMORE, in their order; names of tables without their %."""
    return [word.strip("%") for line in commands for word in line[{"R": 2, "RMORE": 1}.get(line[0], len(line)) :]]


def read_csv(text: str) -> dict[str, np.ndarray]:
    """Columns by their heads; lines that begin with # are sentences."""
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    return {name: np.array(column, dtype=float) for name, *column in zip(*rows, strict=True)}
