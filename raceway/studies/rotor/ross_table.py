"""Coefficients as a file that ROSS reads by itself: ``ross.BearingElement.load(FILE)``.

ROSS is an open program for rotors (github.com/petrobras/ross).  Its axes (X, Y, Z) are (y, z, x) here, so that its kxx is
kyy, kxy is kyz, kyx is kzy, kyy is kzz and its axial kzz is kxx.  What its two generations take differs:

============  ==========================================  =========================================================
ROSS          table over                                  between the points
============  ==========================================  =========================================================
2.x           speed, under the name ``frequency``         smoothing cubic spline (scipy's UnivariateSpline)
3.0 or later  ``speed``, ``frequency``, or both of them   PCHIP through the points, linear beyond the ends
============  ==========================================  =========================================================
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import RacewayError, extra
from raceway.framework.doors import member
from raceway.framework.shown import Fact, Shown
from raceway.plugins.labelled import labelled_dataset
from raceway.plugins.pictures import given_axes
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.rotor.coefficients import SPEED, SPIN, Coefficients

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike
    from xarray import Dataset


def smoothed(axis: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values by ROSS 2 at the points of a table: a cubic smoothing spline with scipy's default bound.

    Parameters
    ----------
    axis, values : (n,), n at least 4

    Notes
    -----
    ``UnivariateSpline`` without ``s`` allows squared deviations of n in all, in the unit of the values: 1 N/m a point for a
    stiffness of 1e8 N/m, and 1 N s/m a point for a damping of perhaps less than that.
    """
    import warnings

    from scipy.interpolate import UnivariateSpline

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # ROSS does the same
        return np.asarray(UnivariateSpline(axis, values)(axis))


def through_points(bearing: Any) -> Any:
    """Let a bearing element of ROSS pass through its points, as ROSS 3 does by itself; returns it.

    Parameters
    ----------
    bearing : ``ross.BearingElement`` with ``frequency`` (n,) and coefficients (n,), changed in place

    Notes
    -----
    Shape-preserving cubics (PCHIP) between the points, straight lines with the end's slope beyond them.
    """
    axis = getattr(bearing, "frequency", None)
    if axis is None or getattr(bearing, "speed", None) is not None:
        return bearing  # constants, or a table of ROSS 3
    for name in [word.removesuffix("_interpolated") for word in vars(bearing) if word.endswith("_interpolated")]:
        setattr(bearing, f"{name}_interpolated", _Points(np.asarray(axis, float), np.asarray(getattr(bearing, name), float)))
    return bearing


class _Points:
    """Interpolation of one coefficient over the axis [rad/s]."""

    def __init__(self, axis: np.ndarray, values: np.ndarray) -> None:
        from scipy.interpolate import PchipInterpolator

        self.ends = axis[0], axis[-1]
        self.inside = PchipInterpolator(axis, values)
        self.slopes = tuple(float(self.inside(end, 1)) for end in self.ends)

    def __call__(self, frequency: ArrayLike) -> np.ndarray:
        x = np.asarray(frequency, dtype=float)
        clipped = np.clip(x, *self.ends)
        slope = np.where(x < self.ends[0], *self.slopes)
        return np.asarray(self.inside(clipped) + slope * (x - clipped))


DISTRIBUTION = "ross-rotordynamics"
GENERATIONS = (2, 3)
#: Our entry -> ROSS's.
NAMES = {
    "kyy": "kxx", "kyz": "kxy", "kzy": "kyx", "kzz": "kyy",
    "cyy": "cxx", "cyz": "cxy", "czy": "cyx", "czz": "cyy", "kxx": "kzz",
}  # fmt: skip
_LOST = (
    "ROSS carries translations only: moments on the ring by its motion, and forces by its tilt, are left out; how the tilt is "
    "held belongs to the numbers above",
    "ROSS is linear: that the stiffness depends on the amplitude is left out",
)


@attrs.frozen(eq=False)
class RossFile:
    """Content of the file.

    Attributes
    ----------
    generation : of ROSS, 2 or 3
    content : the keyword arguments of ``ross.BearingElement`` but for ``notes``, which it leaves alone
    notes : sentences in the file's head
    """

    tag: str
    generation: int
    content: Tables
    notes: tuple[str, ...]

    def write(self, path: Path) -> Path:
        """Write TOML or JSON, by the ending.

        Raises
        ------
        RacewayError
            Another ending, or a folder that cannot be written.
        """
        check_name(path)
        text = self.toml() if path.suffix.lower() == ".toml" else self.json()
        return write_whole(text.encode(), path)

    @property
    def section(self) -> str:
        """ROSS takes the class from the word before the underscore."""
        return f"BearingElement_{self.tag}"

    def json(self) -> str:
        return json.dumps({self.section: {**self.content, "notes": list(self.notes)}}, indent=1, allow_nan=False) + "\n"

    def toml(self) -> str:
        lines = [*(f"# {note}" for note in self.notes), "", f"[{json.dumps(self.section)}]"]
        # JSON's numbers, strings and lists of them are TOML's, and its shortest decimal gives every bit back.
        lines += [f"{name} = {json.dumps(value, allow_nan=False)}" for name, value in self.content.items()]
        return "\n".join(lines) + "\n"


def check_name(path: Path) -> None:
    """Refuse a file that ROSS would not read.

    Raises
    ------
    RacewayError
        For an ending other than .toml and .json.
    """
    if path.suffix.lower() not in (".toml", ".json"):
        raise RacewayError(f"`{path}`: ROSS reads .toml and .json, and tells them by the ending: choose one of them")


def installed_generation() -> int | None:
    """Of the ROSS that is installed here; it is not imported."""
    try:
        major = int(version(DISTRIBUTION).partition(".")[0])
    except PackageNotFoundError:
        return None
    return GENERATIONS[0] if major < GENERATIONS[1] else GENERATIONS[1]


def ross_file(table: Coefficients, generation: int, tag: str, node: int, head: tuple[str, ...]) -> RossFile:
    """The file of a table of coefficients.

    Parameters
    ----------
    generation : 2 or 3
    tag : the element's name in ROSS;  node : of the rotor, where it stands
    head : sentences about where the numbers come from

    Raises
    ------
    RacewayError
        A table over speed and frequency for ROSS 2, which has one axis.
    """
    axes = _axes(table, generation)
    columns = table.columns()
    content: Tables = {"n": node, "tag": tag}
    content |= {ross: columns[ours + table.ending].tolist() for ours, ross in NAMES.items()}
    content |= {name: values.tolist() for name, values in axes.items()}
    notes = (
        *head,
        f"{table.definition}; N/m, N s/m, rad/s",
        "axes: ROSS's X, Y, Z are y, z, x of the bearing",
        *table.notes,
        *_LOST,
    )
    return RossFile(tag, generation, content, (*notes, *_reading_notes(table, generation)))


def _axes(table: Coefficients, generation: int) -> dict[str, np.ndarray]:
    both = table.speed is not None and table.frequency is not None
    if generation < 3:
        if both:
            raise RacewayError(
                f"ROSS 2 takes one axis, and this table goes over speed (`{SPIN}`) and frequency (`{SPEED}`): choose a value of "
                f"one of them with --at, or write it for ROSS 3 with --ross-version 3"
            )
        axis = table.speed if table.speed is not None else table.frequency
        assert axis is not None
        return {"frequency": axis}
    return table.axes


def _reading_notes(table: Coefficients, generation: int) -> list[str]:
    if generation >= 3:
        return ["ROSS 3 passes through every point; beyond the ends it goes on in a straight line"]
    worst = smoothing(table)
    told = ", ".join(f"{name} {_part(value)}" for name, value in worst.items() if value > 1e-12) or "none"
    return [
        "ROSS 2 does not pass through the points: it smooths with a bound of 1 N/m, or 1 N s/m, a point, which is a lot for a "
        f"damping; largest change, of the largest value of its kind: {told}. raceway.export_ross(STORE).element() gives a bearing "
        "that passes through them",
        "beyond the ends ROSS 2 goes on as a cubic, and modal analyses ask at speed 0: let the table begin low",
    ]


def _part(value: float) -> str:
    return f"{value:.1e}" if value < 1e-3 else f"{value:.1%}"


def smoothing(table: Coefficients) -> Mapping[str, float]:
    """Largest change at a point by ROSS 2's own interpolation, over the largest coefficient of its kind; by our names."""

    axis = table.speed if table.speed is not None else table.frequency
    assert axis is not None
    columns = table.columns()
    size = {letter: max(float(np.max(np.abs(v))) for name, v in columns.items() if name[0] == letter) for letter in "kc"}
    return {
        name: float(np.max(np.abs(smoothed(axis, values) - values))) / (size[name[0]] or 1.0)
        for name, values in columns.items()
    }


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
        from raceway.studies.rotor.command import point_rows

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


def ross(asked_by: str, least: int = GENERATIONS[0]) -> Any:
    """The package ``ross``, imported without what its own packages print while they are loaded.

    Parameters
    ----------
    asked_by : what needs it, for the message;  least : generation that it needs

    Raises
    ------
    RacewayError
        ROSS is missing, cannot be imported, or is older.
    """
    try:
        with _silence():
            import ross as found
    except ImportError as why:
        raise RacewayError(f"{asked_by} needs ROSS: {extra('ross')} ({why})") from None
    version = str(getattr(found, "__version__", "of no version"))
    if generation(found) < least:
        raise RacewayError(f"{asked_by} needs ROSS {least}.0 or later, and {version} is installed here: {extra('ross')}")
    return found


def generation(found: Any) -> int:
    """Major number of a ROSS; 0 where it tells none."""
    major = str(getattr(found, "__version__", "")).partition(".")[0]
    return int(major) if major.isdigit() else 0


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Streams of the process, whose compiled packages write past Python."""
    if "ross" in sys.modules:
        yield
        return
    try:
        kept = [os.dup(stream) for stream in (1, 2)]
    except OSError:  # no such streams
        yield
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    try:
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        sys.stdout.flush()
        for stream, old in zip((1, 2), kept, strict=True):
            os.dup2(old, stream)
            os.close(old)
        os.close(nowhere)
