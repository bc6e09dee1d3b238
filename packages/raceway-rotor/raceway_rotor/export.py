"""A swept bearing's coefficients for rotor programs: ``raceway.export_ross``, ``raceway.export_coefficients``, and their answers."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import attrs
import numpy as np

from raceway import RacewayError, SceneError, at_least, door
from raceway.extend import (
    KEY_VALUES, PATH, TEXTS, Fact, Shown, Tables, default_registry, given_axes, head, labelled_dataset, member, numbers_at,
    open_store, parse_at, parse_value, select, slug, tidy, write_whole,
)  # fmt: skip
from raceway_rotor.coefficients import LEAST_POINTS, Coefficients, coefficients, largest, unit
from raceway_rotor.files import PROGRAMS
from raceway_rotor.ross_file import (
    GENERATIONS, NAMES, check_name, installed_generation, ross, ross_content, ross_json, ross_notes, ross_toml,
    through_points,
)  # fmt: skip

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from ross import BearingElement
    from xarray import Dataset

#: File endings of the kinds that have one of their own.
_ENDINGS = {".csv": "csv", ".json": "json"}
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


def ross_table(table: Coefficients, generation: int, tag: str, node: int, origin: tuple[str, ...]) -> RossTable:
    """A table of coefficients for ROSS; ``origin``: sentences about where the numbers come from."""
    content, notes = ross_content(table, generation, tag, node), (*origin, *ross_notes(table, generation))
    return RossTable("ross", table, tag, notes, ross_toml(tag, content, notes), generation, content)


@door
def export_ross(
    data: Dataset | str | Path,
    path: Annotated[str | Path | None, PATH] = None,
    *,
    at: Annotated[Mapping[str, object] | Iterable[str], KEY_VALUES] = (),
    source: str | None = None,
    damping: float = 0.0,
    ross_version: int | str | None = None,
    node: Annotated[int, at_least(0)] = 0,
    tag: str | None = None,
) -> RossTable:
    """Linearised coefficients kyy, kyz, kzy, kzz, cyy ... of a swept bearing, for ROSS.

    Parameters
    ----------
    data : what ``raceway.sweep`` gave (xarray.Dataset), or the folder of its store; at least 5 speeds
    path : .toml or .json file that ROSS reads; None: nothing is written
    at : key -> value of every other axis of the sweep, for instance ``{"load.axial": 1000}``
    source : "rotating", "directions" or "tangent"; by default what the sweep's excitation gives
    damping : cyy and czz [N s/m] where the sweep's own is smaller than its error
    ross_version : 2 or 3; None: of the ROSS that is installed, else 3
    node : of the rotor, where the bearing stands
    tag : the element's name; None: of the bearing's preset

    Returns
    -------
    RossTable
        ``coefficients`` [N/m, N s/m, rad/s], ``notes``, ``write(path)``, and ``element()``, the ross.BearingElement

    Raises
    ------
    SceneError
        Axes that are to be chosen first, too few speeds, or a value that the sweep does not have.
    RacewayError
        A bearing that such coefficients do not describe, points without result, a file that cannot be written.

    Examples
    --------
    The stiffness from standstill on, as tangent of the equilibrium:

    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> bearing = rw.export_ross(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:5"}))
    >>> bearing.tag, (1e-6 * bearing.coefficients.stiffness[:, 0, 0]).round(1).tolist()  # kyy [N/um]
    ('B7206C', [238.2, 238.3, 237.6, 233.5, 223.8])
    """
    if path is not None:
        check_name(Path(path))
    table, tag, origin = _swept(data, at, source, damping, LEAST_POINTS, tag)
    if ross_version is None:
        generation = installed_generation() or GENERATIONS[-1]
    elif str(ross_version) in map(str, GENERATIONS):
        generation = int(ross_version)
    else:
        raise SceneError.at("ross_version", ross_version, f"must be one of {', '.join(map(str, GENERATIONS))}")
    bearing = ross_table(table, generation, tag, node, origin)
    if path is not None:
        bearing.write(path)
    return bearing


@door
def export_coefficients(
    data: Dataset | str | Path,
    path: Annotated[str | Path | None, PATH] = None,
    *,
    kind: str | None = None,
    at: Annotated[Mapping[str, object] | Iterable[str], KEY_VALUES] = (),
    source: str | None = None,
    damping: float = 0.0,
    number: Annotated[int, at_least(1)] = 1,
    node: Annotated[int, at_least(0)] = 0,
    tag: str | None = None,
) -> CoefficientFile:
    """Linearised coefficients of a swept bearing for Nastran (PBUSHT) or Ansys (COMBI214), or as CSV or JSON.

    Parameters
    ----------
    data : what ``raceway.sweep`` gave (xarray.Dataset), or the folder of its store; at least 2 speeds
    path : of the file; None: nothing is written
    kind : "nastran", "ansys", "csv" or "json"; None: by the path's ending, .csv or .json
    at : key -> value of every other axis of the sweep, for instance ``{"load.axial": 1000}``
    source : "rotating", "directions" or "tangent"; by default what the sweep's excitation gives
    damping : cyy and czz [N s/m] where the sweep's own is smaller than its error
    number : of Nastran's property, whose tables have the next twelve; of Ansys' element type and real constants
    node : Nastran's grid point on the shaft, joined to ground; 0: the element is a comment to complete
    tag : the bearing's name; None: of its preset

    Returns
    -------
    CoefficientFile
        ``text``, ``notes``, ``write(path)``

    Raises
    ------
    SceneError
        Axes that are to be chosen first, too few speeds, a value that the sweep does not have, or an unknown kind.
    RacewayError
        Coefficients that the format has no place for, points without result, a file that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    >>> bearing = rw.export_coefficients(rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:20000:3"}), kind="csv")
    >>> bearing.text.splitlines()[len(bearing.notes)].split(",")[:3]
    ['speed [rad/s]', 'kyy [N/m]', 'kyz [N/m]']
    """
    kind = kind_of(kind, path)
    table, tag, origin = _swept(data, at, source, damping, 2, tag)
    program = PROGRAMS[kind]
    notes = (*origin, table.definition, *program.notes(table, number), *table.notes)
    bearing = CoefficientFile(kind, table, tag, notes, program.text(table, notes, number, node, tag))
    if path is not None:
        bearing.write(path)
    return bearing


def kind_of(kind: str | None, path: str | Path | None) -> str:
    """The kind as given, or by the path's ending; SceneError where it is unknown."""
    if kind is None and path is not None:
        kind = _ENDINGS.get(Path(path).suffix.lower())
        if kind is None:
            raise SceneError.at("path", str(path), f"states its kind by the ending: one of {', '.join(_ENDINGS)}")
    if kind not in PROGRAMS:
        raise SceneError.at("kind", kind, f"must be one of {', '.join(PROGRAMS)}")
    return kind


def _swept(
    data: Dataset | str | Path,
    at: Mapping[str, object] | Iterable[str],
    source: str | None,
    damping: float,
    least: int,
    tag: str | None,
) -> tuple[Coefficients, str, tuple[str, ...]]:
    """Coefficients of a sweep, the bearing's name, and sentences on where they come from."""
    dataset = _dataset(data)
    selection = select(dataset, _values_at(at, dataset))
    table = coefficients(selection, source, damping, least)
    name = tag if tag is not None else str(selection.value("bearing.preset") or selection.title.partition("\n")[0])
    return table, slug(name), head(selection)


def _values_at(at: Mapping[str, object] | Iterable[str], data: Dataset) -> Tables:
    """Key -> value, numbers in the units of the keys."""
    if not isinstance(at, Mapping):
        return parse_at(at)
    values = {key: parse_value(value) if isinstance(value, str) else value for key, value in tidy(at).items()}
    return numbers_at(json.loads(data.attrs["scene"]), values, default_registry())


def _dataset(data: Dataset | str | Path) -> Dataset:
    """The labelled results of a sweep, as such or in the folder of its store."""
    if isinstance(data, str | Path):
        with open_store(data) as store:
            return store.to_xarray()
    with suppress(Exception):  # whatever a foreign object makes of being asked
        if hasattr(data, "data_vars") and "scene" in data.attrs:
            return data
    raise RacewayError(f"{type(data).__name__} is no sweep: give what raceway.sweep returned, or the folder of its store")


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
