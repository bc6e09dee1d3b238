"""``raceway export``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
import numpy as np
from rich.console import Group, RenderableType

from raceway.cli.console import warn
from raceway.cli.frame import PATH, attempt, common, record, show
from raceway.errors import SceneError
from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.sweep.store_command import at_option, store_argument

if TYPE_CHECKING:
    from raceway.studies.rotor.files import CoefficientFile
    from raceway.studies.rotor.ross_table import RossTable


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


#: Characters of a line, and of the blanks between two columns.
_WIDTH, _BLANKS = 80, 3


def export_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """The points, what is the same at all of them, what was written, what their reader has to know."""
    rows, constant = point_rows(content)
    parts: list[RenderableType] = [
        Words(f"{content['tag']}, coefficients for {', '.join(content['programs'])}", "bold"),
        *(rows_table(part) for part in _fitting(rows)),
        *map(Words, constant),
    ]
    return Group(*parts, *(Words(f"note: {note}") for note in content["notes"]), *written(files))


def _fitting(rows: list[dict[str, str]]) -> list[list[dict[str, str]]]:
    """The rows as tables that fit the width, each with the axes."""
    axes = [name for name in rows[0] if name.endswith("r/min")]
    width = {
        name: max(len(word) for word in (*name.split("\n"), *(row[name] for row in rows))) + _BLANKS for name in rows[0]
    }
    room = _WIDTH - sum(width[name] for name in axes)
    parts: list[list[str]] = [[]]
    for name in (name for name in rows[0] if name not in axes):
        if parts[-1] and sum(width[one] for one in parts[-1]) + width[name] > room:
            parts.append([])
        parts[-1].append(name)
    return [[{name: row[name] for name in (*axes, *part)} for row in rows] for part in parts]


class ExportOptions(NamedTuple):
    """What ``raceway export`` is given."""

    store: Path
    ross: Path | None
    nastran: Path | None
    ansys: Path | None
    table: Path | None
    at: tuple[str, ...]
    source: str | None
    damping: float
    ross_version: str | None
    node: int
    number: int
    tag: str | None
    as_json: bool

    def others(self) -> list[tuple[str | None, Path]]:
        """Kind and path of each file besides that for ROSS."""
        named = [("nastran", self.nastran), ("ansys", self.ansys), (None, self.table)]
        return [(kind, path) for kind, path in named if path is not None]


@click.command(short_help="Write a sweep's coefficients for a rotor program.")
@store_argument
@click.option("--ross", type=PATH, metavar="FILE", help="A .toml or .json that ross.BearingElement.load reads.")
@click.option("--nastran", type=PATH, metavar="FILE", help="Bulk data: CBUSH, PBUSH, PBUSHT, TABLED1.")
@click.option("--ansys", type=PATH, metavar="FILE", help="APDL commands: COMBI214 with tables over OMEGS.")
@click.option("--table", type=PATH, metavar="FILE", help="A .csv or .json of all numbers, the 5x5 K and C with them.")
@at_option
@click.option(
    "--from", "source", type=click.Choice(["rotating", "directions", "tangent"]),
    help="Where the matrix comes from [rotating force; tangent in a static sweep].",
)  # fmt: skip
@click.option(
    "--damping", type=float, default=0.0, metavar="C",
    help="cyy and czz [N s/m] where the sweep's own is smaller than its error [0].",
)  # fmt: skip
@click.option("--ross-version", type=click.Choice(["2", "3"]), help="Generation of ROSS [the installed one, else 3].")
@click.option(
    "--node", type=click.IntRange(min=0), default=0, show_default=True,
    help="Where the bearing stands: ROSS' node; Nastran's grid point, 0: to complete.",
)  # fmt: skip
@click.option(
    "--number", type=click.IntRange(min=1), default=1, show_default=True,
    help="Of Nastran's property (the next 12 are its tables), of Ansys' element type.",
)  # fmt: skip
@click.option("--tag", metavar="NAME", help="The element's name in ROSS [the bearing's].")
@common
@record(ExportOptions)
def export(given: ExportOptions) -> int:
    """Write kyy, kyz, kzy, kzz, cyy, ... over speed, and over speed and frequency, for a rotor program.

    For ROSS, whose axes X, Y, Z are y, z, x here, for Nastran or Ansys, or as a table of all numbers. The sweep has at
    least 5 values of excitation.speed_rpm, 2 where ROSS is not asked for; over kinematics.spin_speed_rpm as well it becomes
    a table over speed and frequency, which ROSS 3 and --table take. Other axes are chosen with --at. What a program cannot
    carry is said here and in the head of its file.

    \b
    Example:
      raceway export raceway-out/B7206C-sweep --ross bearing.toml \\
          --at load.axial=1000
    \b
    K(n) from 0 r/min on, the tangent of the equilibrium:
      raceway sweep examples/b7206.toml --set identifier.kind=tangent \\
          --grid kinematics.spin_speed_rpm=0:20000:21 --out raceway-out/from-rest
      raceway export raceway-out/from-rest --from tangent --ross bearing.toml
      raceway export raceway-out/from-rest --from tangent \\
          --nastran bearing.bdf --ansys bearing.inp --table bearing.csv
    """
    from raceway.studies.rotor.export import export_coefficients, export_ross, kind_of
    from raceway.studies.rotor.ross_table import check_name, installed_generation

    others = [(kind_of(kind, path), path) for kind, path in given.others()]
    if given.ross is None and not others:
        raise SceneError.at("raceway export", None, "writes nothing: give --ross, --nastran, --ansys or --table with a FILE")
    for path in filter(None, (given.ross, *(path for _, path in others))):
        writable(path.parent)
    same: Tables = {name: getattr(given, name) for name in ("at", "source", "damping", "node", "tag")}
    made: list[tuple[RossTable | CoefficientFile, Path]] = []
    if given.ross is not None:
        check_name(given.ross)
        if given.ross_version is None and installed_generation() is None:
            warn("ROSS is not installed here; the file is for ROSS 3. For ROSS 2: --ross-version 2", label="")
        made.append((export_ross(given.store, ross_version=given.ross_version, **same), given.ross))
    made += [(export_coefficients(given.store, kind=kind, number=given.number, **same), path) for kind, path in others]
    files: list[str] = []
    failed = attempt(lambda: [found.write(path) for found, path in made], files)
    notes = list(dict.fromkeys(note for found, _ in made for note in found.notes))
    programs = [found.program for found, _ in made]
    content: Tables = {
        "store": str(given.store),
        **made[0][0].to_dict(),
        "programs": programs,
        "notes": notes,
        "files": files,
    }
    show(content, given.as_json, failed, lambda: export_screen(content, files))
    return 0
