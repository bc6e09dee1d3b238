"""``raceway fit``, also called ``raceway identify``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from copy import copy
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import click

from raceway.cli.frame import (
    PATH,
    RESULTS,
    attempt,
    common,
    has_matplotlib,
    load,
    out_option,
    plugin_files,
    record,
    set_keys,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable


class FitOptions(NamedTuple):
    """Options of ``raceway fit``."""

    data: Path
    free: tuple[str, ...]
    scene: Path | None
    changes: tuple[str, ...]
    mass: float | None
    slow_roll: Path | None
    run_out: str | None
    columns: tuple[str, ...]
    out: Path | None
    pictures: bool | None
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Numbers of a scene, or K and C of a rig's bearing, from measured data.")
@click.argument("data", type=PATH)
@click.option(
    "--free",
    multiple=True,
    metavar="A.B,C.D",
    help="Keys that are free; a search begins at the scene's numbers. Without: K and C from a rig's signals.",
)
@click.option("--scene", type=PATH, metavar="SCENE", help="The bearing or rig, with load and speed as in the measurement.")
@click.option("--mass", type=float, metavar="KG", help="Moving mass of a record of force and displacement; else it is free.")
@click.option("--slow-roll", type=PATH, metavar="FILE.csv", help="Signals at a low speed, whose run-out is subtracted.")
@click.option("--run-out", metavar="UM,DEG", help="The run-out itself: amplitude [µm] and angle from the mark [deg].")
@click.option(
    "--map", "columns", multiple=True, metavar='"HEADER=NAME"', help='A column by its header: "Ch 1=K [N/µm]", "X [um]=y_um", or =ignore; repeat.'
)  # fmt: skip
@set_keys
@out_option(f"{RESULTS}/DATA-fitted or DATA-identified")
@click.option("--pictures/--no-pictures", default=None, help="Draw PNG figures (default with --free).")
@plugin_files
@common
@record(FitOptions)
def fit(options: FitOptions) -> int:
    """Fit numbers of a scene to measured data, or identify K and C of a bearing from the signals of its rig; intervals at 95 %.

    DATA is a CSV file: a table of measured quantities over keys of the scene (load.axial [N], K [N/µm], K error [N/µm]; errors are
    half-widths at 95 %); the signals of a rig (time_s, y_um, z_um and key, a once-per-turn probe, or speed_rpm; or as other programs
    do, Time (s), X [um], Y [um]); or, without a scene, a record of force and displacement (time_s, force_n, x_um), to which K, C and
    mass are fitted. Semicolons, tabs and decimal commas are read. With --free writes fit.json and fit.png. Without, SCENE has a table
    [rig], and K and C of its bearing are identified from the sensor beside it: identify.json. `raceway identify` is the same command.

    \b
    Example:
      raceway fit measured-k.csv --scene examples/b7206.toml \\
          --free bearing.contact_angle_deg
      raceway fit shaker.csv --free K,C,mass
      raceway study rig examples/test_rig.toml --out rig
      raceway identify rig/signals-13000rpm-400N.csv \\
          --scene examples/test_rig.toml --set load.axial=400 \\
          --slow-roll rig/slow-roll-13000rpm-400N.csv
      raceway identify orbit.csv --scene examples/test_rig.toml \\
          --map "Ch 1=y_um" --map "Ch 2=z_um"
    """
    registry = registry_with(options.plugins)
    columns, run_out = _meanings(options.columns), _vector(options.run_out)
    if not options.free and options.scene is None:
        message = "names nothing: give --free K,C,mass of a record of force and displacement, or --scene of a rig"
        raise SceneError.at("--free", None, message)
    if not options.free and options.mass is not None:
        raise SceneError.at("--mass", options.mass, "belongs to --free and a record of force and displacement")
    scene = None if options.scene is None else load(options.scene, options.changes, registry)
    changes = "" if options.free or scene is None else "".join(scene.title.partition("\n")[1:])
    ending = "fitted" if options.free else "identified"
    folder = writable(options.out or RESULTS / f"{slug(options.data.stem + changes)}-{ending}")
    tell_faults(registry)
    drawing = bool(options.free) if options.pictures is None else options.pictures
    with show_progress() as progress:
        from raceway.studies.fit.fit import fit as fit_numbers
        from raceway.studies.fit.fit import fit_screen
        from raceway.studies.fit.identify import Identified, identify_screen
        from raceway.studies.fit.identify import identify as identify_bearing

        rig: dict[str, Any] = {"slow_roll": options.slow_roll, "run_out": run_out, "columns": columns}
        answer = (
            fit_numbers(
                options.data, scene, options.free, mass=options.mass, plugins=options.plugins, progress=progress, **rig
            )
            if options.free or scene is None
            else identify_bearing(options.data, scene, plugins=options.plugins, progress=progress, **rig)
        )
    content, files = answer.to_dict(), list[str]()
    failed = attempt(lambda: [answer.save(folder)], files)
    if drawing and failed is None and has_matplotlib():
        failed = attempt(
            lambda: answer.pictures(folder) if isinstance(answer, Identified) else [answer.picture(folder)], files
        )
    show(
        content,
        options.as_json,
        failed,
        lambda: identify_screen(answer, files) if isinstance(answer, Identified) else fit_screen(answer, files),
    )
    return 0


identify = copy(fit)
identify.name, identify.short_help = "identify", "The same as fit: without --free K and C from a rig's signals."


def _meanings(texts: tuple[str, ...]) -> dict[str, str]:
    """Column header -> name from ``HEADER=NAME``; a header may have an equals sign, a name has none."""
    columns = {}
    for text in texts:
        header, sign, name = (part.strip() for part in text.rpartition("="))
        if not (sign and header and name):
            raise SceneError.at("--map", text, 'must have the form "HEADER=NAME", for instance "X [µm]=y_um"')
        columns[header] = name
    return columns


def _vector(text: str | None) -> tuple[float, float] | None:
    """Amplitude [m] and angle [deg] from ``UM,DEG``."""
    if text is None:
        return None
    try:
        amplitude, angle = (float(word) for word in text.split(","))
    except ValueError:
        amplitude, angle = float("nan"), 0.0
    if not (isfinite(amplitude) and isfinite(angle) and amplitude >= 0.0):
        raise SceneError.at(
            "--run-out", text, "must be an amplitude of at least 0 µm and an angle in deg, for instance 5.0,70"
        )
    return 1e-6 * amplitude, angle
