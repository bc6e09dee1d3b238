"""A contact law in the laboratory, for Python and the command line alike: ``raceway.law``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.framework.shown import Fact, Shown
from raceway.pipeline.result import damping_origin
from raceway.scene.given import Change, as_given
from raceway.scene.tables import TIME_CONSTANTS
from raceway.storage.tables import Tables
from raceway.studies.law.contact import Contact, contact_of
from raceway.studies.law.cycle import Cycle, cycle

#: The bearing of the article under its load, where no scene is given.
BASE: Tables = {"title": "B7206C, 1 kN axial", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
AMPLITUDE, FREQUENCY = 0.2, 200.0
#: Ends and points of the curves, over the elastic approach of the equilibrium: from an open contact to some three times Hertz' load.
_FIRST, _LAST, _POINTS = -0.2, 2.0, 111
#: Of the table.
_PARTS = (0.25, 0.5, 1.0, 1.5, 2.0)


@attrs.frozen(eq=False, repr=False)
class LawCurves(Shown):
    """What a contact law does with one contact of a bearing, beside Hertz' law.

    Attributes
    ----------
    law : its name;  title : of the scene;  damping_origin : what damps it, in words
    contact : the contact in its equilibrium
    approach : (n,) minus the gap between the undeformed surfaces [m];  rate : (3,) 0 and the cycle's largest, closing and opening [m/s]
    force, stiffness, damping : (3, n) at these rates, each without a history [N, N/m, N s/m]
    hertz_force, hertz_stiffness : (n,) [N, N/m]
    cycle : a harmonic motion about the equilibrium
    rows : of the table: the law at rest and its ratio to Hertz'

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.law("hertz", None, "contact.damping=300")
    >>> [round(1e-6 * found.cycle.stiffness, 1), round(found.cycle.damping, 1)]  # N/um, N s/m
    [86.7, 300.0]
    """

    law: str
    title: str
    damping_origin: str
    contact: Contact
    approach: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    hertz_force: np.ndarray
    hertz_stiffness: np.ndarray
    cycle: Cycle
    rows: tuple[Tables, ...]

    def to_dict(self) -> Tables:
        """Contact, table, curves and cycle as plain tables, SI."""
        curves = ("approach", "rate", "force", "stiffness", "damping", "hertz_force", "hertz_stiffness")
        loop = attrs.asdict(self.cycle)
        return {
            "law": self.law,
            "title": self.title,
            "damping_origin": self.damping_origin,
            **{key: getattr(self.contact, key) for key in ("race", "ball", "load", "approach", "reach", "hertz_factor")},
            "rows": list(self.rows),
            "curves": {name: getattr(self, name).tolist() for name in curves},
            "cycle": {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in loop.items()},
        }

    def picture(self, path: str | Path) -> Path:
        """Draw force, stiffness, damping and the cycle's loop as a PNG file.

        Raises
        ------
        RacewayError
            matplotlib is missing, or a folder that cannot be written.
        """
        from raceway.plugins.pictures import save_figure
        from raceway.studies.law.picture import draw

        return save_figure(draw(self), Path(path))

    def _shown(self) -> tuple[str, list[Fact]]:
        c, loop = self.contact, self.cycle
        return (
            f"{self.law}, {c.race} contact of ball {c.ball}\n{self.title}",
            [
                ("load, approach", f"{c.load:.4g} N", f"{1e6 * c.approach:.4g} µm"),
                ("K, C", f"{1e-6 * loop.stiffness:.4g} N/µm", f"{loop.damping:.4g} N s/m, {loop.frequency:.4g} Hz"),
                ("energy a cycle", f"{1e6 * loop.energy:.3g} µJ", self.damping_origin),
            ],
        )


@door
def law(
    name: str,
    scene: Any = None,
    *changes: Change,
    race: str = "inner",
    ball: int | None = None,
    amplitude: float = AMPLITUDE,
    frequency: float | None = None,
    plugins: Iterable[str | Path] = (),
) -> LawCurves:
    """What a contact law does with one contact of a bearing: force, stiffness, damping, and the energy of a cycle.

    Parameters
    ----------
    name : of the law
    scene : Scene, path, TOML text or dict of tables with rigid bodies; None: B7206C under 1 kN axial load
    changes : of the scene, as ``raceway.evolve`` takes them, for instance ``"contact.damping=300"``
    race : "inner" or "outer";  ball : its number, from 1 over all rows; None: the most loaded one
    amplitude : of the cycle over the elastic approach of the equilibrium
    frequency : of the cycle [Hz]; None: of the scene's excitation, without one 200 Hz
    plugins : files of one-off plug-ins that hold the law

    Returns
    -------
    LawCurves
        ``approach``, ``force``, ``stiffness``, ``damping``, ``hertz_force``, ``cycle``; ``picture(path)``

    Raises
    ------
    SceneError
        An unknown law, mistakes of the scene, bodies that are not rigid, a ball or race that is not there, a cycle without size.
    RacewayError
        A contact that carries nothing.
    ConvergenceError
        No equilibrium.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.law("penalty")
    >>> [round(row["stiffness_ratio"], 2) for row in found.rows]  # against Hertz', at 1/4 to 2 times the approach at rest
    [0.67, 0.94, 1.33, 1.63, 1.89]
    """
    given = as_given(BASE if scene is None else scene).changed({"contact.kind": name}, *changes)
    read = given.scene(registry_with(plugins))
    if read.contact.in_a_band:
        low, high = TIME_CONSTANTS
        rule = (
            f"is a band of time constants, and one contact has one: give contact.time_constant, from {low:g} to {high:g} s"
        )
        raise SceneError.at("contact.damping", "band", rule)
    if frequency is None:
        period = None if read.excitation is None else read.excitation.period_s
        frequency = FREQUENCY if period is None else 1.0 / period
    contact = contact_of(read, race, ball)
    elastic = contact.approach + contact.reach
    size = amplitude * elastic
    approach = np.linspace(_FIRST, _LAST, _POINTS) * elastic - contact.reach
    rate = 2.0 * np.pi * frequency * size * np.array([0.0, 1.0, -1.0])
    force, stiffness, damping = contact.curves(approach, rate)
    hertz_force, hertz_stiffness = contact.hertz(approach)
    return LawCurves(
        read.contact.kind, read.title, damping_origin(read), contact, approach, rate, force, stiffness, damping,
        hertz_force, hertz_stiffness, cycle(contact, size, frequency), tuple(_row(contact, part * elastic) for part in _PARTS),
    )  # fmt: skip


def _row(contact: Contact, elastic: float) -> Tables:
    """The law at rest at an elastic approach [m], and over Hertz'; None where Hertz' contact is open."""
    approach = elastic - contact.reach
    force, stiffness, damping, _ = contact.at(approach)
    ((hertz_force,), (hertz_stiffness,)) = contact.hertz(np.array([approach]))
    closed = approach > 0.0
    return {
        "approach": approach,
        "force": force,
        "force_ratio": force / float(hertz_force) if closed else None,
        "stiffness": stiffness,
        "stiffness_ratio": stiffness / float(hertz_stiffness) if closed else None,
        "damping": damping,
    }
