"""``raceway law``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.commands.frame import PATH, attempt, common, plugin_files, record, set_keys, show
from raceway.storage.files import writable


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
@click.option("--ball", type=click.IntRange(min=1), metavar="NUMBER", help="From 1 [the most loaded].")
@click.option(
    "--amplitude",
    type=float,
    default=0.2,
    show_default=True,
    metavar="PART",
    help="Of the cycle, over the approach at rest.",
)
@click.option("--frequency", type=float, metavar="HZ", help="Of the cycle [the scene's excitation, else 200].")
@click.option("--picture", type=PATH, metavar="FILE.png", help="Draw force, stiffness, damping and the cycle's loop.")
@plugin_files
@common
@record(LawOptions)
def law(given: LawOptions) -> int:
    """One contact of a bearing with the contact law NAME, beside Hertz': force, stiffness and damping over the approach, and a
    cycle about the equilibrium: its hysteresis loop, the energy that it costs, K and C.

    Without SCENE the bearing is B7206C under 1 kN axial load. SCENE needs rigid bodies; its contact.kind is replaced.

    \b
    Example:
      raceway law hertz --set contact.damping=300
      raceway law penalty --set contact.stiffness=1e14 --picture law.png
    """
    from raceway.commands.inputs import require_matplotlib, tell_faults
    from raceway.framework.registry import registry_with
    from raceway.studies.law.front import law as bench
    from raceway.studies.law.screen import law_screen

    if given.picture is not None:
        require_matplotlib("leave out --picture")
        if given.picture.suffix.lower() != ".png":
            raise click.UsageError(f"--picture {given.picture}: the file must end in .png")
        writable(given.picture.parent)
    tell_faults(registry_with(given.plugins))
    found = bench(
        given.name, given.scene, *given.changes, race=given.race, ball=given.ball, amplitude=given.amplitude,
        frequency=given.frequency, plugins=given.plugins,
    )  # fmt: skip
    files: list[str] = []
    place = given.picture
    failed = None if place is None else attempt(lambda: [found.picture(place)], files)
    content = {**found.to_dict(), "files": files}
    show(content, given.as_json, failed, lambda: law_screen(content, files))
    return 0
