"""Numbers from measured data, for Python and the command line alike: ``raceway.fit``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from raceway.commands.progress import telling
from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.scene.given import as_scene
from raceway.studies.fit.data import over_time
from raceway.studies.fit.data import read_table
from raceway.studies.fit.fitted import Fitted
from raceway.studies.fit.kinds import of_record, of_rig, of_table
from raceway.studies.fit.observed import observed
from raceway.studies.measured.from_files import roll_of
from raceway.studies.measured.run_out import given
from raceway.studies.measured.signals import signals_of

if TYPE_CHECKING:
    from raceway.commands.progress import ShowProgress


@door
def fit(
    data: Any,
    scene: Any = None,
    free: Iterable[str] | str = (),
    *,
    mass: float | None = None,
    slow_roll: Any = None,
    run_out: tuple[float, float] | None = None,
    columns: Mapping[str, str] | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Fitted:
    """Numbers of a scene from measured data, by least squares with the scene's exact derivatives.

    Parameters
    ----------
    data : CSV file, mapping of heads to arrays (n,) or pandas.DataFrame: a table of measured quantities over keys of the scene,
        ``load.axial [N], K [N/um], K error [N/um]``, errors as half-widths at 95 %; or the signals of a rig that ``identify`` reads;
        or a record of force and displacement, ``time_s, force_n, x_um``, of one axis or two
    scene : Scene, path, TOML text or dict of tables; with a table ``rig`` for signals; None for a record of force and displacement
    free : keys such as "bearing.contact_angle_deg", a search begins at the scene's numbers; of a record "K", "C", "mass"
    mass : that moves with a record's displacement, where it is known [kg]; None: it is free
    slow_roll, run_out : of a rig's signals, as ``identify`` takes them
    columns : head -> what it is taken for, or "ignore"
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Fitted
        ``found[key]`` the number, ``found.half_width(key)`` that of its interval at 95 %, ``warnings`` what the data do not determine

    Raises
    ------
    SceneError
        What is wrong with data, keys or scene.
    ConvergenceError
        The scene has no answer where the search begins, or the search finds no end.

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> found = rw.fit(data, {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, "bearing.contact_angle_deg")
    >>> found.determined, found.estimate.freedom
    (True, 2)
    """
    names = [part for word in free for part in word.split(",")]
    registry = registry_with(plugins)
    with telling(progress) as told:
        told("reading", 0, 2)
        record = signals_of(data, columns) if over_time(data, columns) else None
        if record is not None and any(name.startswith("force") for name in record.columns):
            refuse(
                scene is not None,
                "scene",
                "a record of force and displacement is fitted by a linear model, not by a scene: leave it out",
            )
            refuse(
                slow_roll is not None or run_out is not None, "slow roll", "belongs to the signals of a rig, without a force"
            )
            told("searching", 1, 2)
            return of_record(record, names, mass)
        refuse(mass is not None, "mass", "belongs to a record of force and displacement; a scene has its own")
        refuse(scene is None, "scene", "is missing: give --scene, whose answers the data are fitted by")
        read = as_scene(scene, plugins=plugins)
        if record is not None:
            roll = roll_of(None if slow_roll is None else signals_of(slow_roll, columns))
            told("searching", 1, 2)
            known = None if run_out is None else given(*run_out)
            return of_rig(record, read, names, registry, known, roll)
        refuse(
            slow_roll is not None or run_out is not None,
            "slow roll",
            "belongs to the signals of a rig over time; the data are a table",
        )
        table, source = read_table(data)
        told("searching", 1, 2)
        return of_table(observed(table, source, read, columns), read, names)


def refuse(wrong: bool, path: str, why: str) -> None:
    """``SceneError`` at an argument that does not belong to the data."""
    if wrong:
        raise SceneError.at(path, None, why)
