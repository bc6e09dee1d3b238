"""Sources of a matrix over y, z: a rotating force, forces along fixed directions, the tangent of an equilibrium.

Each source gives stiffness and damping (..., 2, 2) [N/m, N s/m], where the damping is resolved (..., 2, 2), what they are in words,
and notes for the table's reader.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway import RacewayError, SceneError
from raceway.extend import Z_IMAG, Z_REAL, C, K, Selection, is_number, listed, tilt_words
from collections.abc import Hashable

if TYPE_CHECKING:
    from xarray import Dataset

DIRECTION = "excitation.direction_deg"
#: Backward over forward amplitude, or cross over direct receptance, above which one number does not stand for the bearing.
_MOST_ANISOTROPY = 0.01
#: Share of kyy by which it differs from that of a run, from which on a note says so.
_SOFTER = 1e-3
#: Of ``_across``: squares that leave 1e-16 are 1e-8.
_ROUNDING = 1e-7

#: Stiffness, damping, where it is resolved, definition, notes.
Matrices = tuple[np.ndarray, np.ndarray, np.ndarray, str, list[str]]


def _rotating(selection: Selection) -> Matrices:
    """One complex number for both directions."""
    kind = selection.value("excitation.kind")
    if kind == "unidirectional":
        raise RacewayError(
            "a force along one direction does not show whether the bearing is isotropic. Sweep with "
            f"excitation.kind = bidirectional, over several directions with --grid {DIRECTION}=0,45,90, or use the tangent "
            "of the equilibrium with --from tangent"
        )
    data = selection.dataset
    smaller, larger = np.sort(np.stack([data["forward_amplitude"].values, data["backward_amplitude"].values]), axis=0)
    share = float(np.max(smaller / larger))
    if share > _MOST_ANISOTROPY:
        raise RacewayError(
            f"the bearing is not isotropic: the orbit's counter-rotating part reaches {share:.1%} of the rotating one (at most "
            f"{_MOST_ANISOTROPY:.0%}), so that kyy and kzz differ, and one number does not determine them. Use the tangent of the "
            "equilibrium with --from tangent, or sweep a fixed force over both directions with excitation.kind = unidirectional "
            f"and --grid {DIRECTION}=0,45,90"
        )
    identity = np.eye(2)
    stiffness = data[K.name].values[..., None, None] * identity
    damping = data[C.name].values[..., None, None] * identity
    certain = np.abs(data[Z_IMAG.name].values) > _errors(data) * np.hypot(data[Z_REAL.name].values, data[Z_IMAG.name].values)
    notes = [
        f"isotropic: kyy = kzz = K, cyy = czz = C, no cross terms; the counter-rotating part of the orbits is at most {share:.1e}",
        *_common(selection),
    ]
    words = f"{_kind_words(selection)} under a rotating force ({kind}), {_tilt_words(selection)}"
    return stiffness, damping, np.broadcast_to(certain[..., None, None], damping.shape), words, notes


def _directions(selection: Selection) -> Matrices:
    """Receptances along 0, 90 and 45 deg, inverted as a matrix.

    Along a unit vector n the receptance is h = n' H n: h(0) = Hyy, h(90) = Hzz, h(45) = (Hyy + Hzz + Hyz + Hzy) / 2.  The
    matrix is taken as symmetric.  |Hzy| is known from the orbit under the force along y, too: forward^2 + backward^2 =
    (|x_y|^2 + |x_z|^2) / 2; so the part that gyroscopic moments of the ring make antisymmetric on free tilts,
    |A|^2 = (|Hyz|^2 + |Hzy|^2) / 2 - |Hyz + Hzy|^2 / 4, is an error of the cross terms.  An error dH of H moves Z = H^-1 by at most |Z| |dH| |Z|.
    """
    angles = selection.axes[DIRECTION]
    if not {0, 90} <= set(angles) or not all(is_number(angle) and angle in (0, 45, 90) for angle in angles):
        raise SceneError.at(DIRECTION, None, f"has {listed(angles)} deg; both columns take 0 and 90, cross terms 45, too")
    if selection.value("rotor.polar_inertia", 0.0) and selection.value("supports.tilt") != "locked":
        raise RacewayError(
            "gyroscopic moments (rotor.polar_inertia with free tilts) make the matrix unsymmetric, which forces along fixed "
            "directions do not resolve: set rotor.polar_inertia=0, which the rotor model includes"
        )
    data = selection.dataset
    z = data[Z_REAL.name].values + 1j * data[Z_IMAG.name].values
    w = 2.0 * np.pi * data["frequency"].values
    antisymmetric = np.zeros(z.shape[:-1])
    h = dict(zip(angles, np.moveaxis(1.0 / z, -1, 0), strict=True))
    across = _across(data, angles, h)
    widest = max(0.0, float(np.max(list(across.values()))) - _ROUNDING)
    if 45 in angles:
        cross = h[45] - 0.5 * (h[0] + h[90])
        note = "cross terms from the force along 45 deg, the matrix taken as symmetric"
        if selection.value("supports.tilt", "locked") != "locked":
            power = 0.5 * sum((across[angle] * np.abs(h[angle])) ** 2 for angle in (0, 90))
            antisymmetric = np.sqrt(np.maximum(power - np.abs(cross) ** 2, 0.0))
            share = np.max(antisymmetric / np.abs(h[0]))
            note += f"; the ring's gyroscopic moments add {share:.1e} of H, counted as its error"
    else:
        if widest > _MOST_ANISOTROPY:
            raise RacewayError(
                f"a force along y moves the ring along z by {widest:.1%} of its motion along y: two directions do not determine these "
                f"cross terms. Sweep with --grid {DIRECTION}=0,45,90, or choose --from tangent"
            )
        cross = np.zeros_like(h[0])
        note = f"no cross terms: a force along one direction moves the ring across by at most {widest:.1e} of its motion"
    dynamic = np.linalg.inv(_symmetric(h[0], cross, h[90]))
    errors = {angle: _errors(data)[..., k] * np.abs(h[angle]) for k, angle in enumerate(angles)}
    cross_error = antisymmetric + (errors[45] + 0.5 * (errors[0] + errors[90]) if 45 in angles else 0.0)
    error = np.abs(dynamic) @ _symmetric(errors[0], cross_error, errors[90]) @ np.abs(dynamic)
    w, mass = w[..., 0, None, None], data["mass"].values[..., 0, None, None]
    stiffness = dynamic.real + mass * w**2 * np.eye(2)
    words = f"{_kind_words(selection)} under forces along fixed directions, {_tilt_words(selection)}"
    return stiffness, dynamic.imag / w, np.abs(dynamic.imag) > error, words, [note, *_common(selection)]


def _symmetric(first: np.ndarray, cross: np.ndarray, last: np.ndarray) -> np.ndarray:
    """(..., 2, 2) of the entries (...)."""
    return np.stack([np.stack([first, cross], -1), np.stack([cross, last], -1)], -2)


def _errors(data: Dataset) -> np.ndarray:
    """Relative errors of Z; 0 where none was estimated."""
    if "error_total" not in data:
        return np.zeros(data[Z_REAL.name].shape)
    return np.asarray(np.nan_to_num(data["error_total"].values), dtype=float)


def _across(data: Dataset, angles: list[float], h: dict[Hashable, np.ndarray]) -> dict[int, np.ndarray]:
    """Motion across a force along y (0) and z (90) over the motion along it."""
    across = {}
    for angle in (0, 90):
        k = angles.index(angle)
        turning = data["forward_amplitude"].values[..., k] ** 2 + data["backward_amplitude"].values[..., k] ** 2
        along = (data["force_amplitude"].values[..., k] * np.abs(h[angle])) ** 2
        across[angle] = np.sqrt(np.maximum(2.0 * turning / along - 1.0, 0.0))
    return across


def _tangent(selection: Selection) -> Matrices:
    """The radial part of the equilibrium's tangent, motions that the scene leaves free condensed out.

    With x = T r of the retained motions r, and those that follow them without force, K becomes T' K T and, to first order in the
    frequency, C becomes T' C T.
    """
    if "stiffness" not in selection.dataset:
        raise RacewayError("the sweep holds no tangent of the equilibrium: choose --from rotating")
    matrix = reduced(selection)
    coupling = np.abs(matrix[..., 0, 1:])
    # (..., 5, 3) motion of all coordinates with x, y, z, the tilts as supported.
    whole = np.array(selection.dataset["stiffness"].values, dtype=float)
    follow = np.zeros((*whole.shape[:-2], 5, 3))
    follow[..., :3, :] = np.eye(3)
    if (tilt := selection.value("supports.tilt", "locked")) != "locked":
        follow[..., 3:, :] = -np.linalg.solve(_tilts(whole, tilt), whole[..., 3:, :3])
    transformation = follow[..., 1:]
    notes = []
    radial = matrix[..., 1:, 1:]
    if selection.value("supports.axial") == "force":
        radial = radial - matrix[..., 1:, :1] * matrix[..., :1, 1:] / matrix[..., :1, :1]
        transformation = transformation - follow[..., :1] * matrix[..., :1, 1:] / matrix[..., :1, :1]
        softer = 1.0 - float((np.diagonal(radial, 0, -2, -1) / np.diagonal(matrix, 0, -2, -1)[..., 1:]).min())
        runs = f"; x follows: up to {softer:.1%} below kyy and kzz of a run, which hold it" if softer >= _SOFTER else ""
        notes.append(f"kyy ... kzz at constant axial force (supports.axial), kxx with the radial motions held{runs}")
    else:
        notes.append("kyy ... kzz and kxx with each other's motions held (supports.axial)")
    size = float(np.max(coupling / np.sqrt(np.abs(matrix[..., 0, 0] * matrix[..., 1, 1]))[..., None]))
    if size > 1e-6:
        notes.append(f"left out: the coupling of axial and radial motions, {size:.1e} of the geometric mean of kxx and kyy")
    notes.append("small motions about the equilibrium under the constant loads, independent of the unbalance")
    if selection.value("bearing.preload_kind") == "spring":
        notes.append("rows on the spring follow without friction; kxx with these rows held, as in a motion, is larger")
    damping = np.zeros_like(radial)
    if "damping" in selection.dataset:
        full = np.array(selection.dataset["damping"].values, dtype=float)
        damping = np.swapaxes(transformation, -1, -2) @ full @ transformation
    with_damping = bool(damping.any())
    notes.insert(
        0,
        "damping of the contacts at the equilibrium, of slow motions; at w their time constant tau changes K and C by about "
        "(w tau)^2 / 4: those of the running speed are a sweep's with identifier.kind = 'tangent' (source 'rotating')"
        if with_damping
        else "the tangent of an equilibrium has no damping",
    )
    words = f"tangent of the equilibrium, {_tilt_words(selection)}"
    return radial, damping, np.broadcast_to(with_damping, radial.shape), words, notes


#: What coefficients are taken from.
SOURCES = {"rotating": _rotating, "directions": _directions, "tangent": _tangent}


def reduced(selection: Selection, tilt: float | str | None = None) -> np.ndarray:
    """(..., 3, 3) tangent over x, y, z with the tilts as supported, or as given."""
    matrix = np.array(selection.dataset["stiffness"].values, dtype=float)
    tilt = selection.value("supports.tilt", "locked") if tilt is None else tilt
    if tilt == "locked":
        return matrix[..., :3, :3]
    return matrix[..., :3, :3] - matrix[..., :3, 3:] @ np.linalg.solve(_tilts(matrix, tilt), matrix[..., 3:, :3])


def _tilts(matrix: np.ndarray, tilt: float | str) -> np.ndarray:
    """(..., 2, 2) stiffness against tilts, the shaft's with it."""
    return matrix[..., 3:, 3:] + (0.0 if tilt == "free" else float(tilt)) * np.eye(2)


def tilt_note(selection: Selection) -> list[str]:
    """How the tilt is held in the numbers, and what it is worth."""
    if "stiffness" not in selection.dataset:
        return []
    try:
        with_locked_tilt, free = (reduced(selection, tilt)[..., 1, 1] for tilt in ("locked", "free"))
    except np.linalg.LinAlgError:  # nothing resists a tilt: there is no free one
        return []
    return [
        f"{_tilt_words(selection)} in these numbers; of the tangent, kyy, with the tilts held, is {_micro_range(with_locked_tilt)}, and kyy_tilts_follow, with "
        f"them free, {_micro_range(free)}; supports.tilt = locked is for a stiff rotor, free for a compliant shaft"
    ]


def _micro_range(stiffness: np.ndarray) -> str:
    low, high = (f"{1e-6 * float(end):.4g}" for end in (np.min(stiffness), np.max(stiffness)))
    return f"{low} N/µm" if low == high else f"{low} to {high} N/µm"


def _tilt_words(selection: Selection) -> str:
    return tilt_words(selection.value("supports.tilt", "locked"))


def _kind_words(selection: Selection) -> str:
    return "tangent response" if selection.value("identifier.kind") == "tangent" else "secant"


def _common(selection: Selection) -> list[str]:
    """Notes on the rotor's mass, its other properties, and the force's amplitude."""
    # What the swept rotor brought besides its mass, and a rotor model brings again.
    notes = []
    inertias = [key for key in ("rotor.transverse_inertia", "rotor.polar_inertia") if selection.value(key, 0.0)]
    if inertias and selection.value("supports.tilt", "locked") != "locked":
        notes.append(
            f"{' and '.join(inertias)} resist the free tilt in these numbers and would count twice in a rotor model: sweep with 0"
        )
    if selection.value("rotor.damping", 0.0):
        notes.append("rotor.damping is part of cyy and czz")
    force = selection.dataset["force_amplitude"].values
    low, high = float(np.min(force)), float(np.max(force))
    size = f"{low:.4g} N" if high - low <= 1e-6 * high else f"{low:.4g} to {high:.4g} N"
    of_force = f"under forces of amplitude {size}; in a rotor model, iterate where the bearing force differs"
    return [*_mass(selection), *notes, of_force]


def _mass(selection: Selection) -> list[str]:
    mass = selection.dataset["mass"].values
    if not np.any(mass):
        return ["K = Re Z: the motion has no inertia (quasi-static)"]
    included = "the rotor model includes it, with the inner ring where its shaft does not"
    return [f"K = Re Z + m w^2: the mass that the sweep moved, {float(np.max(mass)):.4g} kg, is removed; {included}"]
