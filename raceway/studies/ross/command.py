"""``raceway export``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.commands.console import warn
from raceway.commands.frame import PATH, attempt, common, record, show
from raceway.commands.inputs import slug
from raceway.storage.files import writable
from raceway.storage.tables import Tables
from raceway.studies.sweep.store_command import at_option, head, selection_of, store_argument, told


class ExportOptions(NamedTuple):
    """What ``raceway export`` is given."""

    store: Path
    ross: Path
    at: tuple[str, ...]
    source: str | None
    damping: float
    ross_version: str | None
    node: int
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
@common
@record(ExportOptions)
def export(given: ExportOptions) -> int:
    """Write kyy, kyz, kzy, kzz, cyy, ... over speed, and over speed and frequency, for ROSS.

    ROSS's axes X, Y, Z are y, z, x here. The sweep has at least 5 values of excitation.speed_rpm; over
    kinematics.spin_speed_rpm as well it becomes a table over speed and frequency, which ROSS 3 takes. Other axes are
    chosen with --at. What ROSS cannot carry is said here and in the head of the file.

    \b
    Example:
      raceway export raceway-out/B7206C-sweep --ross bearing.toml --at load.axial=1000
    """
    from raceway.studies.ross.coefficients import coefficients
    from raceway.studies.ross.file import check_name, installed_generation, ross_file

    check_name(given.ross)
    writable(given.ross.parent)
    selection = selection_of(given.store, given.at)
    found = installed_generation()
    generation = int(given.ross_version) if given.ross_version else found or 3
    if given.ross_version is None and found is None:
        warn("ROSS is not installed here; the file is for ROSS 3. For ROSS 2: --ross-version 2", label="")
    table = coefficients(selection, given.source, given.damping)
    file = ross_file(table, generation, slug(selection.title), given.node, head(selection))
    files: list[str] = []
    failed = attempt(lambda: [file.write(given.ross)], files)
    content: Tables = {
        "store": str(given.store),
        "ross": generation,
        "source": table.source,
        "definition": table.definition,
        "speed": None if table.speed is None else table.speed.tolist(),
        "frequency": None if table.frequency is None else table.frequency.tolist(),
        "coefficients": {name: values.tolist() for name, values in table.columns().items()},
        "notes": list(file.notes),
        "files": files,
    }
    from raceway.commands.screen.text import rows_table

    show(content, given.as_json, failed, lambda: told(export_words(content), rows_table(export_rows(content))))
    return 0


def export_rows(content: Tables) -> list[Tables]:
    """One row a point of a table over one axis; the ends of a table over two."""
    import numpy as np

    axes = {name: content[name] for name in ("speed", "frequency") if content[name] is not None}
    columns = {name: np.array(values) for name, values in content["coefficients"].items()}
    largest = {letter: max(np.max(np.abs(v)) for name, v in columns.items() if name[0] == letter) for letter in "kc"}
    # Cross terms of an isotropic bearing are rounding: columns of it say nothing.
    shown = [name for name, values in columns.items() if np.max(np.abs(values)) > 1e-9 * largest[name[0]]]
    shape = tuple(len(values) for values in axes.values())
    rows = []
    for place in np.ndindex(shape):
        if len(shape) == 2 and any(0 < k < size - 1 for k, size in zip(place, shape, strict=True)):
            continue
        row: Tables = {f"{name} (rad/s)": f"{values[k]:.6g}" for (name, values), k in zip(axes.items(), place, strict=True)}
        for name in shown:
            scale, unit = (1e-6, "N/µm") if name[0] == "k" else (1.0, "N s/m")
            row[f"{name} ({unit})"] = float(columns[name][place]) * scale
        rows.append(row)
    return rows


def export_words(content: Tables) -> list[str]:
    """Definition, assumptions, losses, file."""
    return [f"for ROSS {content['ross']}", *content["notes"], *(f"written: {name}" for name in content["files"])]
