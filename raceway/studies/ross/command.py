"""``raceway export``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.console import warn
from raceway.cli.frame import PATH, attempt, common, record, show
from raceway.errors import SceneError
from raceway.storage.files import writable
from raceway.storage.tables import Tables
from raceway.studies.sweep.store_command import at_option, store_argument

if TYPE_CHECKING:
    from raceway.studies.ross.table import RossTable
    from raceway.studies.rotor_files.file import CoefficientFile


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
    from raceway.studies.ross.file import check_name, installed_generation
    from raceway.studies.ross.front import export_ross
    from raceway.studies.ross.screen import export_screen
    from raceway.studies.rotor_files.front import export_coefficients, kind_of

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
