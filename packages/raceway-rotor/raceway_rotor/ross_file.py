"""Coefficients as a file that ROSS reads by itself, ``ross.BearingElement.load(FILE)``; interpolation there; the ROSS that is installed.

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
import warnings
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from raceway import RacewayError
from raceway.extend import Tables, extra
from raceway_rotor.coefficients import SPEED, SPIN, Coefficients, largest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from ross import BearingElement

_DISTRIBUTION = "ross-rotordynamics"
GENERATIONS = (2, 3)
#: Our entry -> ROSS's.
NAMES = {
    "kyy": "kxx", "kyz": "kxy", "kzy": "kyx", "kzz": "kyy",
    "cyy": "cxx", "cyz": "cxy", "czy": "cyx", "czz": "cyy", "kxx": "kzz",
}  # fmt: skip
_LEFT_OUT = (
    "ROSS carries translations only: moments by translation and forces by tilt are left out; the tilt boundary of the numbers is stated "
    "above",
    "ROSS is linear: the dependence of the stiffness on the amplitude is left out",
)


def ross_content(table: Coefficients, generation: int, tag: str, node: int) -> Tables:
    """Keyword arguments of ``ross.BearingElement``.

    generation : of ROSS, 2 or 3;  tag : the element's name;  node : of the rotor, where it stands

    RacewayError: A table over speed and frequency for ROSS 2, which has one axis.
    """
    axes = table.axes
    if generation < 3:
        if len(axes) > 1:
            raise RacewayError(
                f"ROSS 2 takes one axis, and this table goes over speed (`{SPIN}`) and frequency (`{SPEED}`): choose a value of "
                f"one of them with --at, or write it for ROSS 3 with --ross-version 3"
            )
        axes = {"frequency": table.axis}
    columns = table.columns()
    entries = {ross: columns[ours + table.ending].tolist() for ours, ross in NAMES.items()}
    return {"n": node, "tag": tag, **entries, **{name: values.tolist() for name, values in axes.items()}}


def ross_notes(table: Coefficients, generation: int) -> tuple[str, ...]:
    """What the reader of the file has to know."""
    units = f"{table.definition}; N/m, N s/m, rad/s"
    notes = units, "axes: ROSS's X, Y, Z are y, z, x of the bearing", *table.notes, *_LEFT_OUT
    if generation >= 3:
        return (*notes, "ROSS 3 passes through every point; beyond the ends it extrapolates linearly")
    # Largest change at a point by ROSS 2's own interpolation, over the largest coefficient of its kind
    columns = table.columns()
    sizes = largest(columns)
    smoothing = {
        name: float(np.max(np.abs(ross_spline(table.axis, values) - values))) / (sizes[name[0]] or 1.0)
        for name, values in columns.items()
    }
    changes = {name: f"{by:.1e}" if by < 1e-3 else f"{by:.1%}" for name, by in smoothing.items() if by > 1e-12}
    return (
        *notes,
        "ROSS 2 does not pass through the points: it smooths with a bound of 1 N/m, or 1 N s/m, a point, which is a lot for a "
        "damping; largest change, of the largest value of its kind: "
        f"{', '.join(f'{name} {change}' for name, change in changes.items()) or 'none'}. raceway.export_ross(STORE).element() gives "
        "a bearing that passes through them",
        "beyond the ends ROSS 2 extrapolates by a cubic, and modal analyses start at speed 0: start the table low",
    )


def ross_toml(tag: str, content: Tables, notes: tuple[str, ...]) -> str:
    """The file as TOML; JSON's numbers, strings and lists of them are TOML's, and its shortest decimal gives every bit back."""
    lines = [*(f"# {note}" for note in notes), "", f"[{json.dumps(_toml_section(tag))}]"]
    lines += [f"{name} = {json.dumps(value, allow_nan=False)}" for name, value in content.items()]
    return "\n".join(lines) + "\n"


def ross_json(tag: str, content: Tables, notes: tuple[str, ...]) -> str:
    """The file as JSON."""
    return json.dumps({_toml_section(tag): {**content, "notes": list(notes)}}, indent=1, allow_nan=False) + "\n"


def _toml_section(tag: str) -> str:
    """ROSS takes the class from the word before the underscore."""
    return f"BearingElement_{tag}"


def check_name(path: Path) -> None:
    """Refuse (RacewayError) a file that ROSS would not read: an ending other than .toml and .json."""
    if path.suffix.lower() not in (".toml", ".json"):
        raise RacewayError(f"`{path}`: ROSS reads .toml and .json, by their suffix: choose one of them")


def ross_spline(axis: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values by ROSS 2 at the points of a table: a cubic smoothing spline with scipy's default bound.

    axis, values : (n,), n at least 4

    ``UnivariateSpline`` without ``s`` allows squared deviations of n in all, in the unit of the values: 1 N/m a point for a
    stiffness of 1e8 N/m, and 1 N s/m a point for a damping of perhaps less than that.
    """
    from scipy.interpolate import UnivariateSpline

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # ROSS does the same
        return np.asarray(UnivariateSpline(axis, values)(axis))


def through_points(bearing: BearingElement) -> BearingElement:
    """Let a bearing element of ROSS pass through its points, as ROSS 3 does by itself; returns it.

    bearing : ``ross.BearingElement`` with ``frequency`` (n,) and coefficients (n,), changed in place

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
        within = np.clip(x, *self.ends)
        slope = np.where(x < self.ends[0], *self.slopes)
        return np.asarray(self.inside(within) + slope * (x - within))


def ross(purpose: str, least: int = GENERATIONS[0]) -> ModuleType:
    """The package ``ross``, imported without what its own packages print while they are loaded.

    purpose : what needs it, for the message;  least : generation that it needs

    RacewayError: ROSS is missing, cannot be imported, or is older.
    """
    try:
        with _silence():
            import ross as package
    except ImportError as why:
        raise RacewayError(f"{purpose} needs ROSS: {extra('raceway-rotor[ross]')} ({why})") from None
    if generation(package) < least:
        version = getattr(package, "__version__", "of no version")
        raise RacewayError(
            f"{purpose} needs ROSS {least}.0 or later, and {version} is installed here: {extra('raceway-rotor[ross]')}"
        )
    return package


def generation(package: ModuleType) -> int:
    """Major number of a ROSS; 0 where it has none."""
    major = str(getattr(package, "__version__", "")).partition(".")[0]
    return int(major) if major.isdigit() else 0


def installed_generation() -> int | None:
    """Of the ROSS that is installed here; it is not imported."""
    try:
        major = int(version(_DISTRIBUTION).partition(".")[0])
    except PackageNotFoundError:
        return None
    return GENERATIONS[0] if major < GENERATIONS[1] else GENERATIONS[1]


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Streams of the process, whose compiled packages write past Python."""
    if "ross" in sys.modules:
        yield
        return
    try:
        copies = [os.dup(stream) for stream in (1, 2)]
    except OSError:  # no such streams
        yield
        return
    null = os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    try:
        for stream in (1, 2):
            os.dup2(null, stream)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        sys.stdout.flush()
        for stream, copy in zip((1, 2), copies, strict=True):
            os.dup2(copy, stream)
            os.close(copy)
        os.close(null)
