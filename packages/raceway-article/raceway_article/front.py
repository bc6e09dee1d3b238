"""The article's study by its bodies, and what makes its page again."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from raceway import Answer, Mistake, SceneError
from raceway.extend import Change, SceneSource, ShowProgress, plain_tables, registry_with, telling

#: Options that one choice of bodies has no use for, with the reason.
_NOT_ELASTIC = {
    "speeds": "there is one operating point: --set excitation.speed_rpm=12000",
    "axial": "load cases at rest are fixed; that of the motions: --set load.axial=1000",
    "shaft": "the tilt is locked",
    "processes": "runs take gigabytes each and go one at a time",
}
_ELASTIC_ONLY = {"turns": "the study sets them, or has steady orbits"}


def article(
    scene: SceneSource | None = None,
    *changes: Change,
    bodies: str = "both",
    speeds: str | None = None,
    axial: str | None = None,
    shaft: float | None = None,
    friction: float | None = None,
    turns: int | None = None,
    processes: int | None = None,
    plan: bool = False,
    kept: Path | None = None,
    pictures: Path | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Answer:
    """Compute the article's figures 9 to 12, with a verdict on each of its claims.

    SCENE is the bearing, by default the article's B7206C; the study sets excitation, speed, axial load, tilt, ball inertia, bodies,
    friction and integrator. Writes article.html, figures, article.json and CSV tables. Finished curves are reused from
    DIR/points.sqlite.

    --bodies elastic: the article's mesh without SCENE, four load cases at rest and one operating point under both excitations,
    beside condensed and rigid bodies; takes gigabytes, writes article-elastic.html.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables;  changes : of the scene, as ``raceway.evolve`` takes them
    bodies : what deforms: only the contacts, or finite-element rings and balls, too; elastic: the article's own model at one
        operating point, beside the others
    speeds : speeds in r/min: a,b,c or start:stop:count; None: 10980:15000:9
    axial : axial loads in N; None: 400:2000:9
    shaft : tilt stiffness of the shaft; None: the scene's, or the rig's
    friction : Coulomb coefficient of the runs with friction, 0: none; None: the scene's, or 0.03
    turns : of a motion of elastic bodies, 40 steps each; None: 2
    processes : that work at a time; 0: in this one; None: 2
    plan : print how many points and how long, and stop
    kept : folder that finished curves are stored in and taken from
    pictures : folder for sections of elastic bodies, which are drawn while their arrays are there; None: none are
    progress : called as ``progress(what, done, total)``; an exception stops the study
    plugins : files of one-off plug-ins, which each process loads

    Raises
    ------
    SceneError
        A mistake in the scene or in an option, or one without effect; nothing has been run.
    KeyboardInterrupt
        Finished curves are in ``kept``.
    """
    elastic = bodies == "elastic"
    given = {"speeds": speeds, "axial": axial, "shaft": shaft, "friction": friction, "turns": turns, "processes": processes}
    idle = {name: why for name, why in (_NOT_ELASTIC if elastic else _ELASTIC_ONLY).items() if given[name] is not None}
    if idle:
        words = "has no effect with --bodies {}: {}; leave it out"
        raise SceneError([Mistake(f"--{name}", given[name], words.format(bodies, why)) for name, why in idle.items()])
    files = tuple(map(Path, plugins))
    registry = registry_with(files)
    command = _command(scene, {"bodies": None if bodies == "both" else bodies, **given, "processes": None}, changes, files)
    compute: Callable[..., Answer]
    if elastic:
        from raceway_article.elastic import elastic_article, elastic_workload
        from raceway_article.elastic_design import SCENE, TURNS, design as elastic_design

        tables = plain_tables(SCENE if scene is None else scene, *changes, registry=registry)
        runs = elastic_design(tables, friction, TURNS if turns is None else turns)
        foresee, compute = partial(elastic_workload, runs, kept), partial(elastic_article, runs, pictures, kept)
    else:
        from raceway_article.design import ARTICLE, LOADS, SPEEDS, design

        tables = plain_tables(ARTICLE if scene is None else scene, *changes, registry=registry)
        kinds = ("rigid", "condensed") if bodies == "both" else (bodies,)
        curves = design(tables, speeds or SPEEDS, axial or LOADS, shaft, kinds, friction)
        from raceway_article.study import solve_curves, workload  # mistakes are refused before what computes is loaded

        workers = 2 if processes is None else processes
        foresee, compute = partial(workload, curves, workers, kept), partial(solve_curves, curves, workers, kept)
    if plan:
        return foresee(registry)
    with telling(progress) as report:
        return compute(registry, files, report, command)


def _command(scene: object, options: dict[str, object], changes: Iterable[Change], plugins: Iterable[Path]) -> str:
    """What was typed, as far as it decides the numbers; of a path from the root only the name."""

    def short(file: Path) -> str:
        return file.name if file.is_absolute() else str(file)

    words = ["raceway", "study", "article", *([short(scene)] if isinstance(scene, Path) else [])]
    words += [word for name, value in options.items() if value is not None for word in (f"--{name}", str(value))]
    words += [word for change in changes for word in ("--set", str(change))]
    return shlex.join([*words, *(word for file in plugins for word in ("--plugin", short(file)))])
