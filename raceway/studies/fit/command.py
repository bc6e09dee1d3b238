"""``raceway fit``.  Part of ``raceway.cli``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.commands.frame import (
    PATH,
    RESULTS,
    attempt,
    common,
    out_option,
    plugin_files,
    record,
    set_keys,
    show,
    show_progress,
)
from raceway.commands.inputs import columns_by_head, has_matplotlib, load, slug, tell_faults
from raceway.framework.registry import registry_with
from raceway.storage.files import writable
from raceway.studies.measured.command import run_out_of, run_out_option, slow_roll_option


class FitOptions(NamedTuple):
    """What ``raceway fit`` is given."""

    data: Path
    free: tuple[str, ...]
    scene: Path | None
    changes: tuple[str, ...]
    mass: float | None
    slow_roll: Path | None
    run_out: str | None
    columns: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Numbers of a scene from measured data, with intervals.")
@click.argument("data", type=PATH)
@click.option(
    "--free",
    multiple=True,
    required=True,
    metavar="A.B,C.D",
    help="Keys that are free; a search begins at the scene's numbers.",
)
@click.option("--scene", type=PATH, metavar="SCENE", help="The bearing, with load and speed as in the measurement.")
@click.option("--mass", type=float, metavar="KG", help="Moving mass of a record of force and displacement; else it is free.")
@slow_roll_option
@run_out_option
@click.option(
    "--map", "columns", multiple=True, metavar='"HEAD=NAME"', help='A column by its head: "Ch 1=K [N/µm]", or =ignore; repeat for more.'
)  # fmt: skip
@set_keys
@out_option(f"{RESULTS}/DATA-fitted")
@click.option("--pictures/--no-pictures", default=True, help="Draw data, fit, residuals and region as PNG (default).")
@plugin_files
@common
@record(FitOptions)
def fit(given: FitOptions) -> int:
    """Fit numbers of a scene to measured data: least squares, intervals at 95 %, and what the data do not determine.

    DATA is a CSV file: a table of measured quantities over keys of the scene (load.axial [N], K [N/µm], K error [N/µm]; errors are
    half-widths at 95 %); the signals of a rig that `raceway identify` reads; or, without a scene, a record of force and displacement
    (time_s, force_n, x_um), to which K, C and mass are fitted. Writes fit.json and fit.png.

    \b
    Example:
      raceway fit measured-k.csv --scene examples/b7206.toml \\
          --free bearing.contact_angle_deg
      raceway fit rig/signals-13000rpm-400N.csv \\
          --scene examples/test_rig.toml --set load.axial=400 \\
          --slow-roll rig/slow-roll-13000rpm-400N.csv \\
          --free bearing.contact_angle_deg
      raceway fit shaker.csv --free K,C,mass
    """
    registry = registry_with(given.plugins)
    columns, run_out = columns_by_head(given.columns), run_out_of(given.run_out)
    scene = None if given.scene is None else load(given.scene, given.changes, registry)
    folder = writable(given.out or RESULTS / f"{slug(given.data.stem)}-fitted")
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.studies.fit.front import fit as study

        found = study(
            given.data,
            scene,
            given.free,
            mass=given.mass,
            slow_roll=given.slow_roll,
            run_out=run_out,
            columns=columns,
            plugins=given.plugins,
            progress=progress,
        )
    content, files = found.to_dict(), list[str]()
    failed = attempt(lambda: [found.save(folder)], files)
    if failed is None and given.pictures and has_matplotlib():
        failed = attempt(lambda: [found.picture(folder)], files)
    from raceway.studies.fit.screen import fit_screen

    show(content, given.as_json, failed, lambda: fit_screen(content, files))
    return 0
