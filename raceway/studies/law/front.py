"""A contact law on the bench, for Python and the command line alike: ``raceway.law``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from raceway.errors import SceneError
from raceway.framework.registry import registry_with
from raceway.scene.given import Change, as_given
from raceway.storage.tables import Tables
from raceway.studies.law.bench import LawBench, bench
from raceway.studies.law.contact import contact_of

#: The bearing of the article under its load, where no scene is given.
BASE: Tables = {"title": "B7206C, 1 kN axial", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
AMPLITUDE, FREQUENCY = 0.2, 200.0


def law(
    name: str,
    scene: Any = None,
    *changes: Change,
    race: str = "inner",
    ball: int | None = None,
    amplitude: float = AMPLITUDE,
    frequency: float | None = None,
    plugins: Iterable[str | Path] = (),
) -> LawBench:
    """What a contact law does with one contact of a bearing: force, stiffness, damping, and the energy of a cycle.

    Parameters
    ----------
    name : of the law
    scene : Scene, path, TOML text or dict of tables with rigid bodies; None: B7206C under 1 kN axial load
    changes : of the scene, as ``raceway.evolve`` takes them, for instance ``"contact.damping=300"``
    race : "inner" or "outer";  ball : its number, from 1; None: the most loaded one
    amplitude : of the cycle over the approach of the equilibrium
    frequency : of the cycle [Hz]; None: of the scene's excitation, without one 200 Hz
    plugins : files of one-off plug-ins that hold the law

    Returns
    -------
    LawBench
        ``approach``, ``force``, ``stiffness``, ``damping``, ``hertz_force``, ``cycle``; ``picture(path)``

    Raises
    ------
    SceneError
        An unknown law, mistakes of the scene, elastic bodies, a ball or race that is not there, a cycle without size.
    RacewayError
        A contact that carries nothing.
    ConvergenceError
        No equilibrium.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.law("hertz", None, "contact.damping=300")
    >>> round(found.contact.load, 1), round(found.cycle.damping, 6), bool(abs(found.force - found.hertz_force).max() < 1e-9)
    (257.6, 300.0, True)
    """
    for key, value, least in (("amplitude", amplitude, 0.0), ("frequency", frequency, 0.0)):
        if value is not None and not (math.isfinite(value) and value > least):
            raise SceneError.at(key, value, "must be finite and above 0")
    registry = registry_with([Path(one) for one in plugins])
    given = as_given(BASE if scene is None else scene)
    for change in ({"contact.kind": name}, *changes):
        given = given.changed(change)
    read = given.scene(registry)
    if frequency is None:
        period = None if read.excitation is None else read.excitation.period_s
        frequency = FREQUENCY if period is None else 1.0 / period
    contact = contact_of(read, race, ball)
    return bench(read.contact.kind, read.title, contact, read.contact.law.dissipative, amplitude, frequency)
