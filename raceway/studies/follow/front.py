"""K as a curve over a key of a scene, for Python and the command line alike: ``raceway.follow``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from raceway.commands.progress import ShowProgress, telling
from raceway.errors import SceneError
from raceway.framework.registry import Registry, registry_with
from raceway.scene.file import parse_value, with_value
from raceway.scene.given import Change, plain_tables
from raceway.storage.tables import Tables
from raceway.studies.follow.parameter import Parameter
from raceway.studies.follow.result import Followed
from raceway.studies.follow.study import Rule
from raceway.studies.follow.study import follow as study
from raceway.studies.many.axes import is_number
from raceway.studies.many.points import numbers_at

POINTS, AIM = 1000, 1e-3
_FORM = "must have the form table.key=first:last, for instance excitation.speed_rpm=500:30000"


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
    registry = registry_with([Path(one) for one in plugins])
    tables = plain_tables(scene, *changes, registry=registry)
    parameter = parameter_of(tables, over, registry)
    with telling(progress) as told:
        found = study(parameter, Rule(points, aim, doubled, turns), told)
    if out is not None:
        found.write(out)
    return found


def parameter_of(tables: Tables, over: str, registry: Registry) -> Parameter:
    """The key and its ends of the text ``KEY=first:last``, in a scene that is solved for its steady orbits."""
    key, sign, ends = over.partition("=")
    first, colon, last = ends.partition(":")
    if not (sign and colon and key.strip() and "." in key):
        raise SceneError.at("--over", over, _FORM)
    key = key.strip()
    values = []
    for text in (first, last):
        value = parse_value(text.strip())
        value = numbers_at(tables, {key: value}, registry)[key]
        if not is_number(value):
            raise SceneError.at(key, text, "is no number: only a continuous key can be followed")
        values.append(float(value))
    if values[0] == values[1]:
        raise SceneError.at(key, over, "begins where it ends: there is no branch to follow")
    return Parameter(with_value(tables, "integrator", {"kind": "periodic"}), key, values[0], values[1], registry)
