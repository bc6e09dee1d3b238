"""A bearing's coefficients for ROSS, as an object: numbers, notes, the file, and the element itself."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import RacewayError, extra
from raceway.framework.doors import member
from raceway.framework.shown import Fact, Shown
from raceway.plugins.labelled import labelled_dataset
from raceway.plugins.pictures import given_axes
from raceway.storage.tables import Tables
from raceway.studies.ross.coefficients import Coefficients
from raceway.studies.ross.file import NAMES, RossFile
from raceway.studies.ross.reading import through_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

_RPM = 30.0 / np.pi


@attrs.frozen(eq=False, repr=False)
class RossTable(Shown):
    """Coefficients of one bearing for ROSS.

    Attributes
    ----------
    coefficients : ``speed``, ``frequency`` (n,) [rad/s], ``stiffness`` (..., 2, 2) [N/m], ``damping`` (..., 2, 2) [N s/m] over y, z
    file : what is written for ROSS
    names : our coefficient -> ROSS's, whose X, Y, Z are y, z, x here

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> found = rw.export_ross(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}), tag="left")
    >>> found.tag, found.names["kyy"], found.to_xarray().kyy.attrs["units"]
    ('left', 'kxx', 'N/m')
    """

    coefficients: Coefficients
    file: RossFile

    @property
    def names(self) -> dict[str, str]:
        """Our coefficient -> ROSS's."""
        return {f"{ours}{self.coefficients.ending}": ross for ours, ross in NAMES.items()}

    @property
    def notes(self) -> tuple[str, ...]:
        """What the reader of the numbers has to know, a sentence each."""
        return self.file.notes

    @property
    def program(self) -> str:
        """Whom the file is for."""
        return f"ROSS {self.file.generation}"

    @property
    def tag(self) -> str:
        """The element's name in ROSS."""
        return self.file.tag

    def write(self, path: str | Path) -> Path:
        """Write the TOML or JSON file that ``ross.BearingElement.load`` reads, by the ending.

        Raises
        ------
        RacewayError
            Another ending, or a folder that cannot be written.
        """
        return self.file.write(Path(path))

    def element(self, node: int | None = None) -> Any:
        """The ``ross.BearingElement``, which passes through the points of the table in ROSS 2, too.

        Parameters
        ----------
        node : of the rotor, which the element's tag then names, for a rotor on several; by default the table's own

        Raises
        ------
        RacewayError
            ROSS is missing.
        """
        try:
            from ross import BearingElement
        except ImportError as why:
            raise RacewayError(f"an element needs ROSS: {extra('ross')} ({why})") from None
        at = {} if node is None else {"n": node, "tag": f"{self.tag}, node {node}"}
        given = attrs.evolve(self.file, content={**self.file.content, **at})
        with tempfile.TemporaryDirectory(prefix="raceway-ross-") as folder:
            return through_points(BearingElement.load(given.write(Path(folder) / "bearing.toml")))

    def to_dict(self) -> Tables:
        """The numbers by our names, and the notes, as plain tables."""
        return {
            "ross": self.file.generation,
            "programs": [self.program],
            "tag": self.tag,
            **self.coefficients.to_dict(),
            "notes": list(self.notes),
        }

    def to_xarray(self) -> Dataset:
        """The nine coefficients [N/m, N s/m] over ``speed`` and ``frequency`` [rad/s].

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        axes = self.coefficients.axes
        variables = {
            name: (tuple(axes), values, {"units": "N/m" if name[0] == "k" else "N s/m"})
            for name, values in self.coefficients.columns().items()
        }
        coordinates = {name: (name, values, {"units": "rad/s"}) for name, values in axes.items()}
        return labelled_dataset(
            variables, coordinates, {"definition": self.coefficients.definition, "notes": "\n".join(self.notes)}
        )

    def plot(self, names: tuple[str, ...] = ("kyy", "kzz"), ax: Axes | None = None) -> Axes:
        """Draw coefficients over the speed [r/min]; of a table over both, over the frequency at its first speed.

        Parameters
        ----------
        names : of stiffnesses [N/µm], or of dampings [N s/m]; without their ending
        ax : matplotlib axes; new ones without

        Raises
        ------
        RacewayError
            matplotlib is missing.
        """
        panel, columns = given_axes(ax), self.coefficients.columns()
        name, values = list(self.coefficients.axes.items())[-1]
        stiff = all(one.startswith("k") for one in names)
        for one in names:
            column = columns[member("names", one.removesuffix(self.coefficients.ending) + self.coefficients.ending, columns)]
            column = column if column.ndim == 1 else column[0]
            panel.plot(_RPM * values, column * (1e-6 if one.startswith("k") else 1.0), marker="o", label=one)
        panel.set_xlabel(f"{name} [r/min]")
        panel.set_ylabel("[N/µm]" if stiff else "[N s/m]")
        panel.legend(frameon=False)
        return panel

    def _shown(self) -> tuple[str, list[Fact]]:
        from raceway.studies.ross.points import point_rows

        rows, constant = point_rows(self.to_dict())
        over = " x ".join(f"{len(values)} values of {name}" for name, values in self.coefficients.axes.items())
        ends = [(*_words(row),) for row in (rows[0], rows[-1])]
        same = [("everywhere", "", text) for text in constant]
        # What may make the numbers wrong for a rotor leads: of a text of 15 lines the last notes fall away.
        notes = sorted(self.notes, key=lambda note: "next to nothing" not in note and "in these numbers" not in note)
        told = [("note", "", text) for text in notes]
        return f"{self.tag}, coefficients for ROSS {self.file.generation}\n{over}", [*ends, *same, *told]


def _words(row: dict[str, str]) -> Fact:
    """Where a point lies, and its numbers."""
    told = [(name.split("\n"), value) for name, value in row.items()]
    at = ", ".join(f"{value} r/min" for (_, unit), value in told if unit == "r/min")
    return f"at {at}", "", ", ".join(f"{name} {value} {unit}" for (name, unit), value in told if unit != "r/min")
