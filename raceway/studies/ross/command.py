"""``raceway export``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.commands.console import warn
from raceway.commands.frame import PATH, attempt, common, record, show
from raceway.storage.files import writable
from raceway.storage.tables import Tables
from raceway.studies.sweep.store_command import at_option, store_argument


class ExportOptions(NamedTuple):
    """What ``raceway export`` is given."""

    store: Path
    ross: Path
    at: tuple[str, ...]
    source: str | None
    damping: float
    ross_version: str | None
    node: int
    tag: str | None
    as_json: bool


@click.command(short_help="Write a sweep's coefficients for a rotor program.")
@store_argument
@click.option(
    "--ross", type=PATH, metavar="FILE", required=True,
    help="A .toml or .json that ross.BearingElement.load reads.",
)  # fmt: skip
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
    "--node", type=click.IntRange(min=0), default=0, show_default=True, help="Of the rotor, where the bearing stands."
)
@click.option("--tag", metavar="NAME", help="The element's name in ROSS [the bearing's].")
@common
@record(ExportOptions)
def export(given: ExportOptions) -> int:
    """Write kyy, kyz, kzy, kzz, cyy, ... over speed, and over speed and frequency, for ROSS.

    ROSS's axes X, Y, Z are y, z, x here. The sweep has at least 5 values of excitation.speed_rpm; over
    kinematics.spin_speed_rpm as well it becomes a table over speed and frequency, which ROSS 3 takes. Other axes are
    chosen with --at. What ROSS cannot carry is said here and in the head of the file.

    \b
    Example:
      raceway export raceway-out/B7206C-sweep --ross bearing.toml \\
          --at load.axial=1000
    \b
    K(n) from 0 r/min on, the tangent of the equilibrium:
      raceway sweep examples/b7206.toml --set identifier.kind=tangent \\
          --grid kinematics.spin_speed_rpm=0:20000:21 --out raceway-out/from-rest
      raceway export raceway-out/from-rest --from tangent --ross bearing.toml
    """
    from raceway.studies.ross.file import check_name, installed_generation
    from raceway.studies.ross.front import export_ross

    check_name(given.ross)
    writable(given.ross.parent)
    if given.ross_version is None and installed_generation() is None:
        warn("ROSS is not installed here; the file is for ROSS 3. For ROSS 2: --ross-version 2", label="")
    found = export_ross(
        given.store,
        at=given.at,
        source=given.source,
        damping=given.damping,
        ross_version=given.ross_version,
        node=given.node,
        tag=given.tag,
    )
    files: list[str] = []
    failed = attempt(lambda: [found.write(given.ross)], files)
    content: Tables = {"store": str(given.store), **found.to_dict(), "files": files}
    from raceway.studies.ross.screen import export_screen

    show(content, given.as_json, failed, lambda: export_screen(content, files))
    return 0
