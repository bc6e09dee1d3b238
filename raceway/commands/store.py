"""Commands that read the results of a sweep: ``raceway plot``, ``raceway export``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from raceway.commands.console import warn
from raceway.commands.frame import PATH, attempt, common, show
from raceway.commands.inputs import require_matplotlib, slug, writable

if TYPE_CHECKING:
    from raceway.studies.sweep.selection import Selection

_store = click.argument("store", type=PATH)
_at = click.option("--at", multiple=True, metavar="KEY=VALUE", help="Choose a value of an axis; repeat for more.")


@click.command(short_help="Draw a sweep: curves, maps, surfaces.")
@_store
@click.option("--value", metavar="NAME", help="Quantity, e.g. p0 or stiffness:y,y [equivalent_stiffness].")
@click.option("--x", metavar="KEY", help="Axis to the right [the speed, or the longest one].")
@click.option("--y", metavar="KEY", help="Second axis; in curves what the colours stand for.")
@_at
@click.option(
    "--kind",
    type=click.Choice(["curves", "map", "surface"]),
    help="[map where both axes have more than 8 values, else curves]",
)
@click.option("--out", type=PATH, metavar="FILE", help="A .png or .svg [STORE/NAME-KIND.png].")
@common
def plot(
    store: Path,
    value: str | None,
    x: str | None,
    y: str | None,
    at: tuple[str, ...],
    kind: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Draw one quantity of a sweep over the keys that were varied.

    One more axis becomes panels; what is left over has to be chosen with --at. Points without a result leave gaps, which
    the picture's second line counts.

    \b
    Example:
      raceway plot raceway-out/B7206C-sweep --value p0 --x excitation.speed_rpm --at load.axial=1000
    """
    require_matplotlib("read the values with raceway sweep --json or --csv")
    selection = _selection(store, at)
    from raceway.studies.sweep.plotting import layout

    picture = layout(selection, value, kind, x, y)
    path = out or store / f"{slug(picture.name.replace(':', '-').replace(',', '-'))}-{picture.kind}.png"
    writable(path.parent)
    files: list[str] = []
    failed = attempt(lambda: [picture.write(path)], files)
    content = {
        "store": str(store),
        "value": picture.name,
        "units": picture.data.attrs.get("units"),
        "kind": picture.kind,
        "x": picture.x,
        "y": picture.y,
        "panels": picture.panels,
        "fixed": selection.fixed,
        "unfinished": selection.unfinished,
        "files": files,
    }
    show(content, as_json, failed, lambda _: _told(plot_words(content)))
    return 0


@click.command(short_help="Write a sweep's coefficients for a rotor program.")
@_store
@click.option(
    "--ross", type=PATH, metavar="FILE", required=True,
    help="A .toml or .json that ross.BearingElement.load reads.",
)  # fmt: skip
@_at
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
def export(
    store: Path,
    ross: Path,
    at: tuple[str, ...],
    source: str | None,
    damping: float,
    ross_version: str | None,
    node: int,
    as_json: bool,
) -> int:
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

    check_name(ross)
    writable(ross.parent)
    selection = _selection(store, at)
    found = installed_generation()
    generation = int(ross_version) if ross_version else found or 3
    if ross_version is None and found is None:
        warn("ROSS is not installed here; the file is for ROSS 3. For ROSS 2: --ross-version 2", label="")
    table = coefficients(selection, source, damping)
    file = ross_file(table, generation, slug(selection.title), node, head(selection))
    files: list[str] = []
    failed = attempt(lambda: [file.write(ross)], files)
    content: dict[str, Any] = {
        "store": str(store),
        "ross": generation,
        "source": table.source,
        "definition": table.definition,
        "speed": None if table.speed is None else table.speed.tolist(),
        "frequency": None if table.frequency is None else table.frequency.tolist(),
        "coefficients": {name: values.tolist() for name, values in table.columns().items()},
        "notes": list(file.notes),
        "files": files,
    }
    show(content, as_json, failed, lambda screen: _told(export_words(content), screen.rows_table(export_rows(content))))
    return 0


def _selection(store: Path, at: tuple[str, ...]) -> Selection:
    from raceway.studies.sweep import open_store
    from raceway.studies.sweep.selection import parse_at, select

    return select(open_store(store).to_xarray(), parse_at(at))


def head(selection: Selection) -> tuple[str, ...]:
    """Where the numbers come from, for the first lines of a file."""
    from raceway import __version__
    from raceway.studies.axes import shown

    bearing = selection.value("bearing.preset", "")
    fixed = ", ".join(f"{key} = {shown(value)}" for key, value in selection.fixed.items())
    words = (f"Raceway {__version__}: {selection.title}", f"bearing {bearing}" if bearing else "", fixed)
    return tuple(word.replace("\n", "; ") for word in words if word)


def plot_words(content: dict[str, Any]) -> list[str]:
    """What was drawn, in sentences."""
    axes = [content["x"], *(key for key in (content["y"], content["panels"]) if key)]
    lines = [f"{content['value']} over {', '.join(axes)} ({content['kind']})"]
    if content["unfinished"]:
        lines.append("without result: " + ", ".join(f"{count} {state}" for state, count in content["unfinished"].items()))
    return lines + [f"written: {name}" for name in content["files"]]


def export_rows(content: dict[str, Any]) -> list[dict[str, Any]]:
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
        row: dict[str, Any] = {
            f"{name} (rad/s)": f"{values[k]:.6g}" for (name, values), k in zip(axes.items(), place, strict=True)
        }
        for name in shown:
            scale, unit = (1e-6, "N/µm") if name[0] == "k" else (1.0, "N s/m")
            row[f"{name} ({unit})"] = float(columns[name][place]) * scale
        rows.append(row)
    return rows


def export_words(content: dict[str, Any]) -> list[str]:
    """Definition, assumptions, losses, file."""
    return [f"for ROSS {content['ross']}", *content["notes"], *(f"written: {name}" for name in content["files"])]


def _told(lines: list[str], *tables: Any) -> Any:
    from rich.console import Group
    from rich.text import Text

    return Group(*tables, *(Text(line, no_wrap=line.startswith("written: "), overflow="ignore") for line in lines))
