"""Linearised coefficients kyy, kyz, kzy, kzz, cyy, ... of a bearing over speed and frequency, from a sweep's results.

Three sources, each with its assumption:

``tangent``      the 5x5 tangent of the equilibrium; all four stiffness entries, no damping
``rotating``     the secant under a rotating force; one complex number, which stands for an isotropic bearing
``directions``   secants under forces along fixed directions 0, 90 and, for the cross entries, 45 deg

Frame and signs: docs/physics.md.  Z(w) = K - m w^2 + j w C; the mass is taken out.
"""

import json
import math
from collections.abc import Mapping, Sequence

import attrs
import numpy as np

from raceway import Mistake, RacewayError, SceneError
from raceway.extend import (
    COLUMNS, LIST, TIME_CONSTANTS, Selection, Tables, dry_damping_words, listed, member, radial_note, shown,
)  # fmt: skip
from raceway_rotor.sources import DIRECTION, SOURCES, reduced, tilt_note

SPEED, SPIN = "excitation.speed_rpm", "kinematics.spin_speed_rpm"
#: Entries by name: row and column of the 2x2 matrix over (y, z).
ENTRIES = {"yy": (0, 0), "yz": (0, 1), "zy": (1, 0), "zz": (1, 1)}
LEAST_POINTS = 5
_RADIANS = np.pi / 30.0


@attrs.frozen(eq=False)
class Coefficients:
    """A table over speed (n,), over frequency (m,), or over both (n, m)."""

    speed: np.ndarray | None  # (n,) of the rotor [rad/s], None for a table over frequency alone
    frequency: np.ndarray | None  # (m,) of the vibration [rad/s], None where it equals the speed or nothing depends on it
    #: stiffness, damping : (..., 2, 2) over y, z [N/m, N s/m]
    stiffness: np.ndarray
    damping: np.ndarray
    axial: np.ndarray  # (...,) kxx [N/m]
    source: str  # "rotating", "directions" or "tangent"
    definition: str  # what the numbers are, in words
    notes: tuple[str, ...]  # what the reader of the table has to know, a sentence each
    #: tangent, tangent_damping : (..., 5, 5) of the contacts at the equilibrium, over x, y, z, tilt_y, tilt_z; no motion is
    #: condensed
    tangent: np.ndarray
    tangent_damping: np.ndarray
    tilt: str | float  # how the tilt was held, ``supports.tilt``
    #: numbers of plug-ins of quantities (...,) by name and unit, those that all points have, such as "torque_nm [N m]"
    stated: Mapping[str, np.ndarray] = attrs.field(factory=dict)

    @property
    def ending(self) -> str:
        """Of the coefficients' names: kyy has the tilts held, as everywhere; other supports make it kyy_tilts_follow."""
        return "" if self.tilt == "locked" else "_tilts_follow"

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """``speed``, ``frequency`` [rad/s], those that the table has."""
        both = {"speed": self.speed, "frequency": self.frequency}
        return {name: values for name, values in both.items() if values is not None}

    @property
    def axis(self) -> np.ndarray:
        """(n,) speed or frequency [rad/s] of a table over one of them."""
        (values,) = self.axes.values()
        return values

    def columns(self) -> dict[str, np.ndarray]:
        """``kyy`` ... ``czz`` and ``kxx`` with their ``ending``, each of the table's shape."""
        matrices = {"k": self.stiffness, "c": self.damping}
        across = {f"{k}{name}{self.ending}": m[..., i, j] for k, m in matrices.items() for name, (i, j) in ENTRIES.items()}
        return {**across, f"kxx{self.ending}": self.axial}

    def to_dict(self) -> Tables:
        """Axes [rad/s] and columns as plain tables."""
        return {
            "source": self.source,
            "definition": self.definition,
            "speed": None if self.speed is None else self.speed.tolist(),
            "frequency": None if self.frequency is None else self.frequency.tolist(),
            "coefficients": {name: values.tolist() for name, values in self.columns().items()},
        }


def largest(columns: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Largest magnitude of all stiffnesses ("k") and of all dampings ("c") [N/m, N s/m]."""
    return {kind: max(float(np.abs(v).max()) for name, v in columns.items() if name[0] == kind) for kind in "kc"}


def unit(name: str) -> str:
    """Of a coefficient by its name."""
    return "N/m" if name[0] == "k" else "N s/m"


def coefficients(
    selection: Selection, source: str | None = None, unresolved: float = 0.0, least: int = LEAST_POINTS
) -> Coefficients:
    """The coefficients of a selection.

    source : "rotating", "directions" or "tangent"; by default what the sweep's excitation gives
    unresolved : cyy and czz [N s/m] where the sweep's own is smaller than its error, which may have either sign
    least : points that an axis needs; cubics through them take ``LEAST_POINTS``, where straight lines take 2

    SceneError: Axes that are to be chosen first, too few points on one, or an unknown source.
    RacewayError: Points without result, or a source that this sweep does not have.
    """
    if not (math.isfinite(unresolved) and unresolved >= 0.0):
        raise SceneError.at("--damping", unresolved, "must be a finite damping of at least 0 N s/m")
    purpose = "and a table of coefficients goes over speed and frequency only"
    _only_axes(selection, (SPEED, SPIN, DIRECTION), purpose)
    default = "tangent" if selection.value("excitation.kind") is None else "rotating"
    source = member("source", source or ("directions" if DIRECTION in selection.axes else default), SOURCES)
    if source == "directions":
        if DIRECTION not in selection.axes:
            raise RacewayError(f"there is one direction only: sweep with --grid {DIRECTION}=0,45,90")
        if LIST not in selection.dataset.dims:
            axes = {key: selection.axes[key] for key in sorted(selection.axes, key=lambda key: key == DIRECTION)}
            selection = attrs.evolve(selection, axes=axes, dataset=selection.dataset.transpose(*axes, ...))
    else:
        _only_axes(selection, (SPEED, SPIN), purpose)
    if selection.unfinished:
        remedy = "Finish them with raceway sweep ... --resume (failed: --retry-failed), or choose another part with --at"
        raise RacewayError(f"the table would have gaps: points without result: {selection.gaps}. {remedy}")
    if LIST in selection.dataset.dims:
        raise RacewayError("the points of this sweep fill no grid over speed, and a table needs one: sweep with --grid")
    _refuse_few(selection, least)
    if source != "tangent" and (selection.value("excitation.kind") is None or "z_real" not in selection.dataset):
        raise RacewayError("the swept scene is static and has a tangent only: choose --from tangent")
    stiffness, damping, certain, definition, notes = SOURCES[source](selection)
    damping_at = certain[..., 0, 0] & certain[..., 1, 1]
    damping, changes = without_noise(damping, certain, unresolved)
    notes += [
        *radial_note(json.loads(selection.dataset.attrs.get("given", "{}"))),
        *changes,
        *_band(selection),
        *tilt_note(selection),
        *_dry(source, stiffness, damping, damping_at, unresolved),
    ]
    tangent, tangent_damping = _at_equilibrium(selection, "stiffness"), _at_equilibrium(selection, "damping")
    axial = _without_direction(selection, reduced(selection)) if "stiffness" in selection.dataset else tangent
    data = selection.dataset
    names = [str(name) for name, column in data.items() if "units" in column.attrs and name not in (*COLUMNS, "warnings")]
    numbers = (_without_direction(selection, np.array(data[name].values, dtype=float)) for name in names)
    speed, frequency, arrays = _axes(selection, stiffness, damping, axial[..., 0, 0], tangent, tangent_damping, *numbers)
    stiffness, damping, axial, tangent, tangent_damping, *columns = arrays
    extra = {f"{n} [{data[n].units}]": column for n, column in zip(names, columns, strict=True) if np.isfinite(column).all()}
    tilt = selection.value("supports.tilt", "locked")
    return Coefficients(
        speed, frequency, stiffness, damping, axial, source, definition, tuple(notes), tangent, tangent_damping, tilt, extra
    )


def _at_equilibrium(selection: Selection, name: str) -> np.ndarray:
    """(..., 5, 5) of the equilibria; 0 in a sweep that does not hold it."""
    if name in selection.dataset:
        return _without_direction(selection, np.array(selection.dataset[name].values, dtype=float))
    return np.zeros((*(len(values) for key, values in selection.axes.items() if key != DIRECTION), 5, 5))


def _without_direction(selection: Selection, array: np.ndarray) -> np.ndarray:
    """Without the last axis where it is the direction of the force, on which an equilibrium does not depend."""
    return np.take(array, 0, axis=len(selection.axes) - 1) if DIRECTION in selection.axes else array


def without_noise(damping: np.ndarray, certain: np.ndarray, substitute: float) -> tuple[np.ndarray, list[str]]:
    """Damping (..., 2, 2) with what is not resolved replaced, and what was done.

    Noise of either sign would be read as damping, and a negative one as instability.  A point whose cyy or czz is not resolved has
    no cross terms either: they alone would make the matrix indefinite.
    """
    diagonal = (certain[..., 0, 0] & certain[..., 1, 1])[..., None, None]
    clean = np.where(certain & diagonal, damping, 0.0) + np.where(diagonal, 0.0, substitute * np.eye(2))
    if diagonal.all():
        return clean, []
    value = f"cyy = czz = {substitute:g} N s/m stands there, as given" if substitute else "0 stands there"
    count = int((~diagonal).sum())
    return clean, [f"damping is not resolved at {count} of {diagonal.size} points, smaller than its error: {value}"]


def _band(selection: Selection) -> list[str]:
    """That the damping of a band is that of one end."""
    if selection.value("contact.damping") != "band":
        return []
    low, high = TIME_CONSTANTS
    remedy = f"for both ends sweep --grid contact.time_constant={low:g},{high:g} instead and export one at a time"
    return [f"contact.damping = 'band': the damping is that of the low end, c = tau k with tau = {low:g} s; {remedy}"]


def _dry(source: str, stiffness: np.ndarray, damping: np.ndarray, with_damping: np.ndarray, substitute: float) -> list[str]:
    """That a dry bearing damps next to nothing; not where a damping is given for points without one."""
    if substitute:
        return []
    largest = float(np.max(damping[..., 0, 0][with_damping])) if with_damping.any() else 0.0 if source == "tangent" else None
    in_contacts = "give contact.damping (N s/m, each contact) accordingly, or, where C is not resolved, "
    remedy = f"{'' if source == 'tangent' else in_contacts}--damping C (in Python damping=C)"
    words = dry_damping_words(largest, float(np.max(stiffness[..., 0, 0])), remedy)
    return [] if words is None else [words]


def _refuse_few(selection: Selection, least: int) -> None:
    speeds = [key for key in (SPEED, SPIN) if key in selection.axes]
    if not speeds:
        value = selection.value(SPEED)
        constant = f"`{SPEED}` has the one value {shown(value)}" if value is not None else "the scene has no speed"
        raise SceneError.at(SPEED, None, f"does not vary here ({constant}): sweep it, as by --grid {SPEED}=1000:15000:15")
    rule, mistakes = f"rotor programs put cubics through them, which takes at least {least} on an axis", list[Mistake]()
    for key in speeds:
        if len(values := selection.axes[key]) < least:
            remedy = f"sweep with --grid {key}=START:STOP:{least} or more"
            mistakes.append(Mistake(key, None, f"has {len(values)} points ({listed(values)}); {rule}: {remedy}"))
    if mistakes:
        raise SceneError(mistakes)


def _axes(selection: Selection, *arrays: np.ndarray) -> tuple[np.ndarray | None, np.ndarray | None, tuple[np.ndarray, ...]]:
    """Axes [rad/s], None where there is none, and the arrays; both axes in the order (speed, frequency)."""
    spins, speeds = (np.array(selection.axes.get(key, []), dtype=float) * _RADIANS for key in (SPIN, SPEED))
    if len(spins) and len(speeds):
        if [key for key in selection.axes if key in (SPIN, SPEED)] != [SPIN, SPEED]:
            arrays = tuple(np.swapaxes(array, 0, 1) for array in arrays)
        return spins, speeds, arrays
    if len(spins):
        return spins, None, arrays
    return (speeds, None, arrays) if selection.value(SPIN) is None else (None, speeds, arrays)


def _only_axes(selection: Selection, allowed: Sequence[str], purpose: str) -> None:
    """Refuse axes that would have to be chosen first: ``SceneError`` with each axis, its values and what to type."""
    mistakes = list[Mistake]()
    for key, values in selection.axes.items():
        if key not in allowed:
            choice = f"choose one with --at {key}={shown(values[0])}"
            mistakes.append(Mistake(key, None, f"has {len(values)} values ({listed(values)}), {purpose}: {choice}"))
    if mistakes:
        raise SceneError(mistakes)
