"""``raceway fit``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import click

from raceway.cli.frame import (
    PATH,
    RESULTS,
    attempt,
    columns_by_head,
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


class IdentifyOptions(NamedTuple):
    """What ``raceway identify`` is given."""

    signals: Path
    scene: Path
    slow_roll: Path | None
    run_out: str | None
    columns: tuple[str, ...]
    changes: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


slow_roll_option = click.option(
    "--slow-roll", type=PATH, metavar="FILE.csv",
    help="Signals at a low speed, whose run-out is subtracted.",
)  # fmt: skip
run_out_option = click.option(
    "--run-out", metavar="UM,DEG", help="The run-out itself: amplitude [µm] and angle from the mark [deg]."
)


@click.command(short_help="K and C of a bearing from measured signals.")
@click.argument("signals", type=PATH)
@click.option(
    "--scene", required=True, type=PATH, metavar="SCENE",
    help="The rig: a scene with a table [rig]; load.axial as in the measurement.",
)  # fmt: skip
@slow_roll_option
@run_out_option
@click.option(
    "--map", "columns", multiple=True, metavar='"HEAD=NAME"',
    help='A column by its head: "X [um]=y_um", or =ignore; repeat for more.',
)  # fmt: skip
@set_keys
@out_option(f"{RESULTS}/SIGNALS")
@click.option("--pictures", is_flag=True, help="Also draw signals, spectrum and orbits as PNG.")
@plugin_files
@common
@record(IdentifyOptions)
def identify(given: IdentifyOptions) -> int:
    """Identify a bearing's K and C, with their uncertainty, from the signals of a sensor beside it.

    SIGNALS is a CSV file whose first line names its columns: time_s, y_um, z_um and key (once-per-turn probe) or speed_rpm,
    or as other programs do, Time (s), X [um], Y [um]; semicolons, tabs and decimal commas are read. Samples may be uneven
    and the speed may change by some per cent. Writes identify.json.

    \b
    Example:
      raceway study rig examples/test_rig.toml --out rig
      raceway identify rig/signals-13000rpm-400N.csv \\
          --scene examples/test_rig.toml --set load.axial=400 \\
          --slow-roll rig/slow-roll-13000rpm-400N.csv
      raceway identify orbit.csv --scene examples/test_rig.toml \\
          --map "Ch 1=y_um" --map "Ch 2=z_um"
    """
    from raceway.scene.reading import rig_of

    registry = registry_with(given.plugins)
    loaded = load(given.scene, given.changes, registry)
    rig_of(loaded)
    vector, columns = run_out_of(given.run_out), columns_by_head(given.columns)
    changed = loaded.title.partition("\n")[1:]
    folder = writable(given.out or RESULTS / f"{slug(''.join([given.signals.stem, *changed]))}-identified")
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.pipeline.result import write_json
        from raceway.studies.fit.identify import CONTENT
        from raceway.studies.fit.identify import identify as study

        found = study(given.signals, loaded, slow_roll=given.slow_roll, run_out=vector, columns=columns, progress=progress)
    content, files = found.to_dict(), list[str]()
    failed = attempt(lambda: [write_json(content, folder / CONTENT)], files)
    if pictures and failed is None:
        from raceway.plugins.pictures import save_figure
        from raceway.studies.fit.picture import figures

        failed = attempt(
            lambda: [save_figure(figure, folder / f"{name}.png", 110) for name, figure in figures(found).items()], files
        )
    from raceway.studies.fit.identify import identify_screen

    show(content, given.as_json, failed, lambda: identify_screen(content, files))
    return 0


def run_out_of(text: str | None) -> tuple[float, float] | None:
    """Amplitude [m] and angle [deg] from ``UM,DEG``."""
    if text is None:
        return None
    from math import isfinite

    try:
        amplitude, angle = (float(word) for word in text.split(","))
    except ValueError:
        amplitude, angle = float("nan"), 0.0
    if not (isfinite(amplitude) and isfinite(angle) and amplitude >= 0.0):
        raise SceneError.at(
            "--run-out", text, "must be an amplitude of at least 0 µm and an angle in deg, for instance 5.0,70"
        )
    return 1e-6 * amplitude, angle


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
        from raceway.studies.fit.fit import fit as study

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
    from raceway.studies.fit.fit import fit_screen

    show(content, given.as_json, failed, lambda: fit_screen(content, files))
    return 0
