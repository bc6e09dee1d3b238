"""``raceway export``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from raceway.cli.console import warn
from raceway.cli.frame import PATH, at_option, attempt, common, show
from raceway.errors import SceneError
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.studies.rotor.export import CoefficientFile


@click.command(short_help="Write a sweep's coefficients for a rotor program.")
@click.argument("store", type=PATH)
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
def export(
    store: Path,
    ross: Path | None,
    nastran: Path | None,
    ansys: Path | None,
    table: Path | None,
    number: int,
    ross_version: str | None,
    as_json: bool,
    **common_options: Any,
) -> int:
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
    from raceway.studies.rotor.ross_file import check_name, installed_generation

    paths = {"nastran": nastran, "ansys": ansys, None: table}
    other_programs = [(kind_of(kind, path), path) for kind, path in paths.items() if path is not None]
    if ross is None and not other_programs:
        raise SceneError.at("raceway export", None, "writes nothing: give --ross, --nastran, --ansys or --table with a FILE")
    for path in filter(None, (ross, *(path for _, path in other_programs))):
        writable(path.parent)
    exports: list[tuple[CoefficientFile, Path]] = []
    if ross is not None:
        check_name(ross)
        if ross_version is None and installed_generation() is None:
            warn("ROSS is not installed here; the file is for ROSS 3. For ROSS 2: --ross-version 2", label="")
        exports.append((export_ross(store, ross_version=ross_version, **common_options), ross))
    exports += [
        (export_coefficients(store, kind=kind, number=number, **common_options), path) for kind, path in other_programs
    ]
    files: list[str] = []
    failed = attempt(lambda: [bearing.write(path) for bearing, path in exports], files)
    content: Tables = {
        "store": str(store),
        **exports[0][0].to_dict(),
        "programs": [bearing.program for bearing, _ in exports],
        "notes": list(dict.fromkeys(note for bearing, _ in exports for note in bearing.notes)),
        "files": files,
    }
    show(content, as_json, failed, lambda: _screen(content))
    return 0


def _screen(content: ReadTables) -> RenderableType:
    """The points, what is the same at all of them, what was written, what their reader has to know."""
    from rich.console import Group

    from raceway.out.table import rows_table, written
    from raceway.out.wrapping import Words
    from raceway.studies.rotor.export import point_rows

    rows, constant = point_rows(content)
    return Group(
        Words(f"{content['tag']}, coefficients for {', '.join(content['programs'])}", "bold"),
        rows_table(rows),
        *map(Words, constant),
        *(Words(f"note: {note}") for note in content["notes"]),
        *written(content["files"]),
    )
