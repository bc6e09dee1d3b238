"""A contact's curves and cycle as an object."""

from __future__ import annotations

from pathlib import Path

import attrs
import numpy as np

from raceway.framework.shown import Fact, Shown
from raceway.storage.tables import Tables
from raceway.studies.law.contact import Contact
from raceway.studies.law.cycle import Cycle, cycle

#: Approaches of the curves, over that of the equilibrium: from an open contact to about three times Hertz' load.
_FIRST, _LAST, _POINTS = -0.2, 2.0, 111
#: Of the table.
SHOWN = (0.25, 0.5, 1.0, 1.5, 2.0)


@attrs.frozen(eq=False, repr=False)
class LawBench(Shown):
    """What a contact law does with one contact of a bearing.

    Attributes
    ----------
    law : its name;  title : of the scene
    contact : the contact in its equilibrium
    approach : (n,) [m], negative where the contact is open
    force, stiffness, damping : (n,) by the law at rest [N, N/m, N s/m]
    closing, opening : (n,) force at the cycle's largest rate, either way [N]
    hertz_force, hertz_stiffness : (n,) by Hertz' law [N, N/m]
    cycle : a harmonic motion about the equilibrium
    dissipative : whether the law itself says that it loses energy
    """

    law: str
    title: str
    contact: Contact
    approach: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    closing: np.ndarray
    opening: np.ndarray
    hertz_force: np.ndarray
    hertz_stiffness: np.ndarray
    cycle: Cycle
    dissipative: bool

    def rows(self) -> list[Tables]:
        """The table: the law beside Hertz' at some approaches."""
        found = []
        for part in SHOWN:
            approach = part * self.contact.approach
            force, stiffness, damping, _ = self.contact.at(approach)
            hertz_force, hertz_stiffness = self.contact.hertz(np.array([approach]))
            found.append(
                {
                    "approach": approach,
                    "force": force,
                    "hertz_force": float(hertz_force[0]),
                    "stiffness": stiffness,
                    "hertz_stiffness": float(hertz_stiffness[0]),
                    "damping": damping,
                }
            )
        return found

    def to_dict(self) -> Tables:
        """Contact, table, curves and cycle as plain tables, SI."""
        curves = ("approach", "force", "stiffness", "damping", "closing", "opening", "hertz_force", "hertz_stiffness")
        loop = attrs.asdict(self.cycle)
        return {
            "law": self.law,
            "title": self.title,
            "race": self.contact.race,
            "ball": self.contact.ball,
            "load": self.contact.load,
            "approach": self.contact.approach,
            "hertz_factor": self.contact.hertz_factor,
            "dissipative": self.dissipative,
            "rows": self.rows(),
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
        from raceway.plugins.reports.pictures import save_figure
        from raceway.studies.law.picture import draw

        return save_figure(draw(self), Path(path))

    def _shown(self) -> tuple[str, list[Fact]]:
        c, loop = self.contact, self.cycle
        return (
            f"{self.law}, {c.race} contact of ball {c.ball}\n{self.title}",
            [
                ("load, approach", f"{c.load:.4g} N", f"{1e6 * c.approach:.4g} µm"),
                *(
                    (f"at {1e6 * r['approach']:.4g} µm", f"{r['force']:.4g} N", f"Hertz {r['hertz_force']:.4g} N")
                    for r in self.rows()
                ),
                (f"cycle, {loop.frequency:.4g} Hz, {1e6 * loop.amplitude:.3g} µm", f"{1e6 * loop.energy:.3g} µJ", "lost"),
                ("K, C", f"{1e-6 * loop.stiffness:.4g} N/µm", f"{loop.damping:.4g} N s/m"),
            ],
        )


def bench(law: str, title: str, contact: Contact, dissipative: bool, amplitude: float, frequency: float) -> LawBench:
    """Curves and a cycle of a contact.

    Parameters
    ----------
    amplitude : of the cycle over the approach of the equilibrium;  frequency : [Hz]
    """
    approach = np.linspace(_FIRST, _LAST, _POINTS) * contact.approach
    force, stiffness, damping = contact.curves(approach)
    size = amplitude * contact.approach
    rate = 2.0 * np.pi * frequency * size
    closing, opening = (contact.curves(approach, way * rate)[0] for way in (1.0, -1.0))
    found = cycle(contact, contact.approach, size, frequency)
    return LawBench(
        law,
        title,
        contact,
        approach,
        force,
        stiffness,
        damping,
        closing,
        opening,
        *contact.hertz(approach),
        found,
        dissipative,
    )
