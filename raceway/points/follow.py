"""K as a curve over a key of a scene, for Python and the command line alike: ``raceway.follow``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry, registry_with
from raceway.out.progress import ShowProgress, telling
from raceway.points.axes import numbers_at
from raceway.points.branch import Followed
from raceway.points.continuation import FollowInterrupt, Rule
from raceway.points.continuation import follow as study
from raceway.points.parameter import Parameter
from raceway.scene.changes import parse_value, with_value
from raceway.scene.continuous import key_of
from raceway.scene.given import Change, plain_tables
from raceway.scene.reading import scene_from_dict
from raceway.scene.units import number_in
from raceway.storage.tables import Tables

POINTS, AIM = 1000, 1e-3
_FORM = "must have the form table.key=first:last, for instance excitation.speed_rpm=500:30000"


@door
def follow(
    scene: Any,
    over: str,
    *changes: Change,
    points: int = POINTS,
    aim: float = AIM,
    doubled: bool = False,
    turns: int = 0,
    out: str | Path | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Followed:
    """Follow the steady orbit of a scene over a continuous key, through folds, with its stability.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables; its integrator and identifier count for nothing
    over : ``"table.key=first:last"``, values as numbers or with units
    changes : of the scene, as ``raceway.evolve`` takes them
    points : orbits at most
    aim : deviation of an orbit from its prediction along the tangent, over its size, that steps are chosen for
    doubled : follow the branches of twice the period that leave it at period doublings, too
    turns : of a time integration from beside the most unstable orbit of each unstable stretch; 0: none
    out : folder for follow.json, follow.csv and follow.png; None: nothing is written
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Followed
        ``rows`` with K [N/m], C [N s/m], amplitude [m] and verdict; ``labels``: folds, period doublings, Neimark-Sacker points,
        branch points and peaks; ``unstable`` stretches, ``instead``: what
        happens there; ``doubled`` branches; ``end``: why the branch ends before the last value, "" where it does not

    Raises
    ------
    SceneError
        A key that is not continuous, or a range whose ends or middle are no scenes.
    ConvergenceError
        No orbit at the first value.
    FollowInterrupt
        On Ctrl-C: a KeyboardInterrupt with the curve up to there as ``partial``; it is written to ``out``, too, without a picture.

    Notes
    -----
    The derivatives by the state are exact; that by the key is a central difference quotient of the balance of forces.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 6000, "amplitude": "constant", "force": 50.0},
    ...     "rotor": {"mass": 2.0, "damping": 1000.0},
    ... }
    >>> found = rw.follow(scene, "excitation.speed_rpm=5000:15000")
    >>> [label.kind for label in found.labels], found.rows[-1].verdict
    ([], 'stable')
    """
    registry = registry_with(plugins)
    tables = plain_tables(scene, *changes, registry=registry)
    parameter = parameter_of(tables, over, registry)
    try:
        with telling(progress) as told:
            found = study(parameter, Rule(points, aim, doubled, turns), told)
    except FollowInterrupt as stop:
        if out is not None and stop.partial.rows:
            stop.partial.write(out, picture=False)
        raise
    if out is not None:
        found.write(out)
    return found


def parameter_of(tables: Tables, over: str, registry: Registry) -> Parameter:
    """The key and its ends of the text ``KEY=first:last``, in a scene that is solved for its steady orbits."""
    key, sign, ends = over.partition("=")
    texts = ends.split(":")
    if not (sign and len(texts) == 2 and "." in key):
        raise SceneError.at("--over", over, _FORM)
    key, tables = key.strip(), with_value(tables, "integrator", {"kind": "periodic"})
    # What has no number yet, as supports.tilt = "free", is read with one; keys of lists have theirs.
    given = [parse_value(text) for text in texts]
    if "[" not in key:
        given = [numbers_at(tables, {key: value}, registry)[key] for value in given]
        tables = with_value(tables, key, given[0])
    whole = scene_from_dict(tables, registry)
    unit = key_of(whole, key).unit
    first, last = (_number(key, value, unit) for value in given)
    if first == last:
        raise SceneError.at(key, over, "begins where it ends: there is no branch to follow")
    return Parameter(whole, key, first, last)


def _number(key: str, value: Any, unit: str) -> float:
    try:
        return number_in(unit, value) if isinstance(value, str) else float(value)
    except (TypeError, ValueError):
        raise SceneError.at(key, value, "is no number: only a continuous key can be followed") from None
