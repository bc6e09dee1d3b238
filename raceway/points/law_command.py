"""``raceway law``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.frame import PATH, attempt, common, plugin_files, record, set_keys, show, show_progress
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from rich.console import RenderableType


class LawOptions(NamedTuple):
    """What ``raceway law`` is given."""

    name: str
    scene: Path | None
    changes: tuple[str, ...]
    race: str
    ball: int | None
    amplitude: float
    frequency: float | None
    picture: Path | None
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="What a contact law does: force, stiffness, damping, energy a cycle.")
@click.argument("name")
@click.argument("scene", type=PATH, required=False)
@set_keys
@click.option("--race", type=click.Choice(["inner", "outer"]), default="inner", show_default=True, help="Of the contact.")
@click.option("--ball", type=int, metavar="NUMBER", help="From 1 [the most loaded].")
@click.option(
    "--amplitude", type=float, default=0.2, show_default=True, metavar="PART", help="Of the cycle, over the elastic approach at rest."
)  # fmt: skip
@click.option("--frequency", type=float, metavar="HZ", help="Of the cycle [the scene's excitation, else 200].")
@click.option("--picture", type=PATH, metavar="FILE.png", help="Draw force, stiffness, damping and the cycle's loop.")
@plugin_files
@common
@record(LawOptions)
def law(given: LawOptions) -> int:
    """One contact of a bearing with the contact law NAME, beside Hertz': force, stiffness and damping over the approach, and a
    cycle about the equilibrium: the energy that it costs, K and C.

    Without SCENE the bearing is B7206C under 1 kN axial load. SCENE needs rigid bodies; its contact.kind is replaced.

    \b
    Example:
      raceway law hertz --set contact.damping=300
      raceway law penalty --picture penalty.png
      raceway law film --set contact.viscosity=0.03 \\
          --set kinematics.spin_speed_rpm=10000
    """
    from raceway.cli.frame import require_matplotlib, tell_faults
    from raceway.framework.registry import registry_with

    place = given.picture
    if place is not None:
        require_matplotlib("leave out --picture")
        if place.suffix.lower() != ".png":
            raise click.UsageError(f"--picture {place}: the file must end in .png")
        writable(place.parent)
    tell_faults(registry_with(given.plugins))
    with show_progress():
        from raceway.points.law import law as curves

        found = curves(
            given.name, given.scene, *given.changes, race=given.race, ball=given.ball, amplitude=given.amplitude,
            frequency=given.frequency, plugins=given.plugins,
        )  # fmt: skip
    files: list[str] = []
    failed = None if place is None else attempt(lambda: [found.picture(place)], files)
    content = {**found.to_dict(), "files": files}
    show(content, given.as_json, failed, lambda: _screen(content, files))
    return 0


def _screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """The contact, the law beside Hertz', the cycle."""
    from rich.console import Group

    from raceway.out.table import rows_table, sections, written
    from raceway.out.wrapping import Words

    head = (
        f"{content['law']}: {content['race']} contact of ball {content['ball']}, {content['load']:.4g} N at an approach of "
        f"{1e6 * content['approach']:.4g} µm"
    )
    reach = content["reach"]
    far = [Words(f"it begins to carry at a gap of {1e6 * reach:.4g} µm")] if reach > 0.0 else []
    rows = [
        {
            "approach\nµm": f"{1e6 * row['approach']:.4g}",
            "force\nN": f"{row['force']:.5g}",
            "F over\nHertz'": _ratio(row["force_ratio"]),
            "stiffness\nN/µm": f"{1e-6 * row['stiffness']:.5g}",
            "k over\nHertz'": _ratio(row["stiffness_ratio"]),
            "damping\nN s/m": f"{row['damping']:.4g}",
        }
        for row in content["rows"]
    ]
    loop = content["cycle"]
    told = [
        ("Cycle", "", ""),
        ("amplitude", f"{1e6 * loop['amplitude']:.4g} µm", f"about the equilibrium, at {loop['frequency']:.4g} Hz"),
        ("stiffness K", f"{1e-6 * loop['stiffness']:.5g} N/µm", "in phase with the approach"),
        ("damping C", f"{loop['damping']:.4g} N s/m", "in phase with its rate"),
        ("energy lost", f"{1e6 * loop['energy']:.4g} µJ", f"a cycle; {content['damping_origin']}"),
        ("loss factor", _ratio(loop["loss_factor"]), "w C / K"),
    ]
    opens = [Words("the contact opens on the way")] if loop["opens"] else []
    title = Words(content["title"], "dim")
    return Group(Words(head, "bold"), title, *far, rows_table(rows), sections(told), *opens, *written(files))


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
