"""Files of coefficients for rotor programs, and for ROSS: what they hold, and their texts."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import attrs
import numpy as np

from raceway import at_least, door
from raceway.extend import PATH, TEXTS, Fact, Shown, Tables, given_axes, labelled_dataset, member, write_whole
from raceway_rotor.coefficients import Coefficients, largest, unit
from raceway_rotor.files import PROGRAMS
from raceway_rotor.ross_file import NAMES, check_name, ross, ross_json, ross_toml, through_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from ross import BearingElement
    from xarray import Dataset

_RPM = 30.0 / np.pi
#: Cross terms of an isotropic bearing, and changes along an axis, below this part of the largest of their kind are rounding.
_ROUNDING = 1e-9


@attrs.frozen(eq=False, repr=False)
class CoefficientFile(Shown):
    """Coefficients of one bearing, written for one program.

    Attributes
    ----------
    kind : "nastran", "ansys", "csv" or "json"; "ross" of a ``RossTable``
    coefficients : ``speed``, ``frequency`` (n,) [rad/s], ``stiffness`` (..., 2, 2) [N/m], ``damping`` (..., 2, 2) [N s/m] over y, z,
        and ``tangent``, ``tangent_damping`` (..., 5, 5) of the equilibria
    tag : the bearing's name
    notes : what the reader of the numbers has to know, a sentence each; the file begins with them
    text : the file

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> bearing = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}), kind="ansys", number=3)
    >>> [line for line in bearing.text.splitlines() if line.startswith(("ET", "KEYOPT", "R,"))]
    ['ET,3,COMBI214', 'KEYOPT,3,2,1', 'R,3,%K11_3%,%K22_3%,0,0,0,0']
    """

    kind: str
    coefficients: Coefficients
    tag: str
    notes: tuple[str, ...]
    text: str

    @property
    def program(self) -> str:
        """The program that the file is for."""
        return PROGRAMS[self.kind].name

    def to_dict(self) -> Tables:
        """The numbers by our names, and the notes, as plain tables."""
        return {"programs": [self.program], "tag": self.tag, **self.coefficients.to_dict(), "notes": list(self.notes)}

    @door
    def write(self, path: Annotated[str | Path, PATH]) -> Path:
        """Write the file, whole or not at all.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return write_whole(self.text.encode(), Path(path))

    def to_xarray(self) -> Dataset:
        """The nine coefficients [N/m, N s/m] over ``speed`` and ``frequency`` [rad/s].

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        axes = self.coefficients.axes
        columns = self.coefficients.columns().items()
        variables = {name: (tuple(axes), values, {"units": unit(name)}) for name, values in columns}
        coordinates = {name: (name, values, {"units": "rad/s"}) for name, values in axes.items()}
        attributes = {"definition": self.coefficients.definition, "notes": "\n".join(self.notes)}
        return labelled_dataset(variables, coordinates, attributes)

    @door
    def plot(self, names: Annotated[tuple[str, ...], TEXTS] = ("kyy", "kzz"), ax: Axes | None = None) -> Axes:
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
        panel, columns, ending = given_axes(ax), self.coefficients.columns(), self.coefficients.ending
        axis, values = list(self.coefficients.axes.items())[-1]
        for name in names:
            column = columns[member("names", name.removesuffix(ending) + ending, columns)]
            column = column if column.ndim == 1 else column[0]
            panel.plot(_RPM * values, column * (1e-6 if name.startswith("k") else 1.0), marker="o", label=name)
        panel.set_xlabel(f"{axis} [r/min]")
        panel.set_ylabel("[N/µm]" if all(name.startswith("k") for name in names) else "[N s/m]")
        panel.legend(frameon=False)
        return panel

    def _facts(self) -> tuple[str, list[Fact]]:
        rows, constant = point_rows(self.coefficients.axes, self.coefficients.columns())
        over = " x ".join(f"{len(values)} values of {name}" for name, values in self.coefficients.axes.items())
        # What may make the numbers wrong for a rotor leads: of a text of 15 lines the last notes fall away.
        notes = sorted(self.notes, key=lambda note: "rule of thumb" not in note and "in these numbers" not in note)
        facts = [("everywhere", "", text) for text in constant]
        for row in (rows[-1], rows[0]):  # the speeds of a point, and its numbers
            cells = [(*title.split("\n"), value) for title, value in row.items()]
            speeds = ", ".join(f"{value} {unit}" for _, unit, value in cells if unit == "r/min")
            numbers = ", ".join(f"{name} {value} {unit}" for name, unit, value in cells if unit != "r/min")
            facts.insert(0, (f"at {speeds}", "", numbers))
        return f"{self.tag}, coefficients for {self.program}\n{over}", [*facts, *(("note", "", text) for text in notes)]


@attrs.frozen(eq=False, repr=False)
class RossTable(CoefficientFile):
    """Coefficients of one bearing for ROSS.

    Attributes
    ----------
    coefficients, tag, notes : as of a ``CoefficientFile``;  text : the file as TOML
    generation : of ROSS, 2 or 3
    content : the keyword arguments of ``ross.BearingElement``
    names : our coefficient -> ROSS's, whose X, Y, Z are y, z, x here

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> left = rw.export_ross(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}), tag="left")
    >>> left.tag, left.names["kyy"], left.to_xarray().kyy.attrs["units"]
    ('left', 'kxx', 'N/m')
    """

    generation: int
    content: Tables

    @property
    def names(self) -> dict[str, str]:
        """Our coefficient -> ROSS's."""
        return {f"{ours}{self.coefficients.ending}": theirs for ours, theirs in NAMES.items()}

    @property
    def program(self) -> str:
        """The program that the file is for."""
        return f"ROSS {self.generation}"

    def to_dict(self) -> Tables:
        """The numbers by our names, and the notes, as plain tables."""
        return {"ross": self.generation, **CoefficientFile.to_dict(self)}

    @door
    def write(self, path: Annotated[str | Path, PATH]) -> Path:
        """Write the TOML or JSON file that ``ross.BearingElement.load`` reads, by the ending.

        Raises
        ------
        RacewayError
            Another ending, or a folder that cannot be written.
        """
        path = Path(path)
        check_name(path)
        text = self.text if path.suffix.lower() == ".toml" else ross_json(self.tag, self.content, self.notes)
        return write_whole(text.encode(), path)

    @door
    def element(self, node: Annotated[int | None, at_least(0)] = None) -> BearingElement:
        """The ``ross.BearingElement``, which passes through the points of the table in ROSS 2, too.

        Parameters
        ----------
        node : of the rotor, which the element's tag then names, for a rotor on several; by default the table's own

        Raises
        ------
        RacewayError
            ROSS is missing.
        """
        package = ross("an element")
        content = self.content if node is None else {**self.content, "n": node, "tag": f"{self.tag}, node {node}"}
        with tempfile.TemporaryDirectory(prefix="raceway-ross-") as folder:
            file = write_whole(ross_toml(self.tag, content, self.notes).encode(), Path(folder) / "bearing.toml")
            return through_points(package.BearingElement.load(file))


def point_rows(axes: Mapping[str, np.ndarray], columns: Mapping[str, np.ndarray]) -> tuple[list[dict[str, str]], list[str]]:
    """Rows of a table over one axis, the corners of one over two, by name and unit; sentences on what does not vary.

    Columns with the same text at all points are one, ``kyy = kzz``; stiffnesses in N/µm, speeds in r/min.
    """
    axes = {f"{name}\nr/min": _RPM * values for name, values in axes.items()}
    bound = {kind: _ROUNDING * size for kind, size in largest(columns).items()}
    zero = [name for name, values in columns.items() if np.max(np.abs(values)) <= bound[name[0]]]
    alike: dict[tuple[str, ...], list[str]] = {}
    for name, values in columns.items():
        if name not in zero:
            alike.setdefault((name[0], *(_file_text(name, value) for value in values.flat)), []).append(name)
    constant, varying = [], {}
    for name, *equal in alike.values():
        # What all names end with stands once.
        title = " = ".join(word[:3] for word in (name, *equal)) + name[3:].replace("_", " ")
        unit_shown = "N/µm" if name[0] == "k" else "N s/m"
        if np.ptp(columns[name]) <= bound[name[0]]:
            constant.append(f"{title} = {_file_text(name, columns[name].flat[0])} {unit_shown} at all points")
        else:
            varying[f"{title}\n{unit_shown}"] = name
    shape = tuple(len(values) for values in axes.values())
    rows = []
    for point in np.ndindex(shape):
        if len(shape) == 1 or all(k in (0, size - 1) for k, size in zip(point, shape, strict=True)):
            row = {title: f"{values[k]:.6g}" for (title, values), k in zip(axes.items(), point, strict=True)}
            rows.append(row | {title: _file_text(name, float(columns[name][point])) for title, name in varying.items()})
    return rows, [*constant, *([f"0 at all points: {', '.join(zero)}"] if zero else [])]


def _file_text(name: str, value: float) -> str:
    return f"{value * (1e-6 if name[0] == 'k' else 1.0):.5g}"
