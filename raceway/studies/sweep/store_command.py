"""Commands that read the results of a sweep: ``raceway plot``, ``raceway export``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.frame import PATH, attempt, common, record, require_matplotlib, show, slug
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.studies.sweep.selection import Selection

store_argument = click.argument("store", type=PATH)
#: Beginning of a line that names a file.
WRITTEN = "written: "
at_option = click.option("--at", multiple=True, metavar="KEY=VALUE", help="Choose a value of an axis; repeat for more.")


class PlotOptions(NamedTuple):
    """What ``raceway plot`` is given."""

    store: Path
    value: str | None
    x: str | None
    y: str | None
    at: tuple[str, ...]
    kind: str | None
    out: Path | None
    as_json: bool


@click.command(short_help="Draw a sweep: curves, maps, surfaces.")
@store_argument
@click.option("--value", metavar="NAME", help="Quantity, e.g. p0 or stiffness:y,y [equivalent_stiffness].")
@click.option("--x", metavar="KEY", help="Axis to the right [the speed, or the longest one].")
@click.option("--y", metavar="KEY", help="Second axis; in curves what the colours stand for.")
@at_option
@click.option(
    "--kind",
    type=click.Choice(["curves", "map", "surface"]),
    help="[map where both axes have more than 8 values, else curves]",
)
@click.option("--out", type=PATH, metavar="FILE", help="A .png or .svg [STORE/NAME-KIND.png].")
@common
@record(PlotOptions)
def plot(given: PlotOptions) -> int:
    """Draw one quantity of a sweep over the keys that were varied.

    One more axis becomes panels; what is left over has to be chosen with --at. Points without a result leave gaps, which
    the picture's second line counts.

    \b
    Example:
      raceway plot raceway-out/B7206C-sweep --value p0 \\
          --x excitation.speed_rpm --at load.axial=1000
    """
    require_matplotlib("read the values with raceway sweep --json or --csv")
    selection = selection_of(given.store, given.at)
    from raceway.studies.sweep.plotting import layout

    picture = layout(selection, given.value, given.kind, given.x, given.y)
    path = given.out or given.store / f"{slug(picture.name.replace(':', '-').replace(',', '-'))}-{picture.kind}.png"
    writable(path.parent)
    files: list[str] = []
    failed = attempt(lambda: [picture.write(path)], files)
    content = {
        "store": str(given.store),
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
    show(content, given.as_json, failed, lambda: told(plot_words(content)))
    return 0


def selection_of(store: Path, at: tuple[str, ...]) -> Selection:
    from raceway.studies.sweep import open_store
    from raceway.studies.sweep.selection import parse_at, select

    return select(open_store(store).to_xarray(), parse_at(at))


def head(selection: Selection) -> tuple[str, ...]:
    """Where the numbers come from, for the first lines of a file."""
    from raceway import __version__
    from raceway.studies.many.axes import shown

    bearing = selection.value("bearing.preset", "")
    fixed = ", ".join(f"{key} = {shown(value)}" for key, value in selection.fixed.items())
    words = (f"Raceway {__version__}: {selection.title}", f"bearing {bearing}" if bearing else "", fixed)
    return tuple(word.replace("\n", "; ") for word in words if word)


def plot_words(content: Tables) -> list[str]:
    """What was drawn, in sentences."""
    axes = [content["x"], *(key for key in (content["y"], content["panels"]) if key)]
    lines = [f"{content['value']} over {', '.join(axes)} ({content['kind']})"]
    if content["unfinished"]:
        lines.append("without result: " + ", ".join(f"{count} {state}" for state, count in content["unfinished"].items()))
    return lines + [f"{WRITTEN}{name}" for name in content["files"]]


def told(lines: list[str], *tables: RenderableType) -> RenderableType:
    from rich.console import Group

    from raceway.out.table import written
    from raceway.out.wrapping import Words

    names = [line.removeprefix(WRITTEN) for line in lines if line.startswith(WRITTEN)]
    return Group(*tables, *(Words(line) for line in lines if not line.startswith(WRITTEN)), *written(names))
