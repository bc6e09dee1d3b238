"""A rolling bearing as an element of ROSS that computes its coefficients itself.  Importing this module imports ROSS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway import RacewayError, SceneError
from raceway.extend import SceneSource, slug
from raceway_rotor.node_bearing import node_bearing
from raceway_rotor.ross_file import generation, ross, through_points

if TYPE_CHECKING:
    from pint import Quantity

_ross = ross("raceway.ross.RollingBearing")
_Element: Any = _ross.BearingElement
#: Of the table that ROSS's plots and files show [r/min].
_SPEEDS_RPM = np.linspace(0.0, 30_000.0, 7)
#: ROSS's coefficient -> row and column in X, Y, Z.
_ENTRIES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1), "zz": (2, 2)}


class RollingBearing(_Element):
    """A ``ross.BearingElement`` whose K and C are those of a bearing of Raceway at (frequency, speed).

    Parameters
    ----------
    bearing : name of a preset (``"7014C"``), or a scene: Scene, path, TOML text, dict of tables
    preload : axial load of the shaft on the inner ring [N] along ROSS's z; a negative one faces the other way.  None: the
        scene's own loads, along z
    n : node;  n_link : node of the housing, if it is not the ground
    tilt : of the inner ring: "locked", "free", the shaft's stiffness against tilts [N m/rad], or "node": the ring tilts with
        the node (alpha, beta), and K and C are (5, 5).  None: the scene's ``supports.tilt``
    axial : "force": the axial load stays (springs), and kzz is a spring beside the bearing; "displacement": the ring is the
        node's along z, too (spacers), and its load follows from the motion.  None: the scene's ``supports.axial``
    damping : added to cxx, cyy, czz [N s/m]; a dry bearing itself damps next to nothing
    speeds : (m,) of ROSS's own table [rad/s], for its plots and files; by default 0 to 30 000 r/min
    tag : by default the bearing's name with the node

    Attributes
    ----------
    node_bearing : the bearing in its own axes, without ROSS

    Raises
    ------
    SceneError
        With every mistake of the scene.
    ConvergenceError
        No equilibrium under these loads at one of the ``speeds``.

    Notes
    -----
    K and C are those of small motions about the equilibrium under the preload, whose speed unloads inner races.
    ``run_unbalance_response`` replaces them by those of the rotor's own motion.  Masses are the rotor model's: the inner ring's, and
    that of the scene's [rotor].

    Examples
    --------
    >>> from raceway.ross import RollingBearing
    >>> element = RollingBearing("B7206C", preload=1000.0, n=0)
    >>> (1e-6 * element.K(1256.6)).round(1).tolist()  # [N/um], at 12 000 r/min
    [[235.3, 0.0, 0.0], [0.0, 235.3, 0.0], [0.0, 0.0, 61.5]]
    """

    def __init__(
        self,
        bearing: SceneSource,
        preload: float | None = None,
        *,
        n: int,
        n_link: int | None = None,
        tilt: float | str | None = None,
        axial: str | None = None,
        damping: float = 0.0,
        speeds: Sequence[float] | np.ndarray | None = None,
        tag: str | None = None,
        scale_factor: float = 1.0,
        color: str = "#355d7a",
    ) -> None:
        if preload is not None and not (np.isfinite(preload) and preload != 0.0):
            raise SceneError.at("preload", preload, "must be an axial load in N, negative for a bearing that faces -z")
        if tilt == "node" and n_link is not None:
            rule = "ROSS links translations only: leave `n_link` out, or choose 'locked', 'free' or a stiffness"
            raise SceneError.at("tilt", tilt, rule)
        self.side = -1 if preload is not None and preload < 0.0 else 1
        self.node_bearing = node_bearing(bearing, None if preload is None else abs(preload), tilt, axial, damping)
        self._at_motion: dict[float, np.ndarray] = {}
        self._dofs: dict[str, int] | None = None
        axis = np.asarray(speeds if speeds is not None else _SPEEDS_RPM * pi / 30.0, dtype=float)
        if axis.ndim != 1 or len(axis) < 2 or not np.all(np.diff(axis) > 0.0):
            raise SceneError.at("speeds", speeds, "must be two or more ascending speeds in rad/s")
        scene = self.node_bearing.scene
        name = slug(str(scene.source["bearing"].get("preset") or scene.title.partition("\n")[0]))
        tag = tag if tag is not None else f"{name}, node {n}"
        self.n_link = n_link
        table = {"frequency" if generation(_ross) < 3 else "speed": axis, **self._table(axis)}
        super().__init__(n=n, n_link=n_link, tag=tag, scale_factor=scale_factor, color=color, **table)
        through_points(self)

    def _table(self, axis: np.ndarray) -> dict[str, np.ndarray]:
        """Coefficients over the speeds, by ROSS's names."""
        z = np.array([self.across(self.node_bearing.dynamic_stiffness(w, w)) for w in axis])
        slow = np.maximum(axis, 1e-3)
        stiffness = {f"k{name}": z.real[:, row, column] for name, (row, column) in _ENTRIES.items()}
        return stiffness | {f"c{name}": z.imag[:, row, column] / slow for name, (row, column) in _ENTRIES.items()}

    @property
    def frame(self) -> np.ndarray:
        """(n, m) our coordinates x, y, z, tilts by the element's degrees of freedom: X, Y, Z are y, z, x."""
        side = self.side
        rotation = np.zeros((5, 5))
        rotation[[0, 1, 2, 3, 4], [2, 0, 1, 3, 4]] = side, 1.0, side, 1.0, side
        shaft = rotation[: self.node_bearing.size, : self.node_bearing.size]
        return shaft if self.n_link is None else np.hstack([shaft, -shaft])

    def across(self, matrix: np.ndarray) -> np.ndarray:
        """A matrix (n, n) of our coordinates over the element's degrees of freedom."""
        return np.asarray(self.frame.T @ matrix @ self.frame)

    @property
    def dof_global_index(self) -> dict[str, int] | None:
        """Degree of freedom by name in the rotor, which sets it; with the node's tilts where they are the ring's."""
        return self._dofs

    @dof_global_index.setter
    def dof_global_index(self, index: Mapping[str, int] | None) -> None:
        self._dofs = None if index is None else dict(index)
        if self._dofs is not None and self.node_bearing.tilts:
            first = self._dofs[f"x_{self.n}"]
            self._dofs |= {f"alpha_{self.n}": first + 3, f"beta_{self.n}": first + 4}

    @property
    def dofs(self) -> list[int]:
        """Degrees of freedom of the rotor at the element's nodes."""
        if self._dofs is None:
            raise RacewayError(f"{self.tag} stands in no rotor yet: hand it to ross.Rotor first")
        return list(self._dofs.values())

    def holding(self, values: Mapping[float, np.ndarray]) -> RollingBearing:
        """A copy with other Z (n, n) at some synchronous speeds [rad/s]."""
        twin = copy(self)
        twin._at_motion = dict(values)
        return twin

    def _dynamic(self, frequency: float | Quantity, speed: float | Quantity | None) -> np.ndarray:
        w = _radians(frequency)
        spin = w if speed is None else _radians(speed)
        at_motion = self._at_motion.get(spin) if w == spin else None
        return self.across(self.node_bearing.dynamic_stiffness(w, abs(spin)) if at_motion is None else at_motion)

    def K(self, frequency: float | Quantity, speed: float | Quantity | None = None) -> np.ndarray:
        """Stiffness over the element's degrees of freedom [N/m, N, N m/rad] at a frequency and a speed of the ring [rad/s]."""
        return np.ascontiguousarray(self._dynamic(frequency, speed).real)

    def C(self, frequency: float | Quantity, speed: float | Quantity | None = None) -> np.ndarray:
        """Damping over the element's degrees of freedom [N s/m] at a frequency and a speed of the ring [rad/s]."""
        return np.ascontiguousarray(self._dynamic(frequency, speed).imag / max(abs(_radians(frequency)), 1e-3))

    def M(self, frequency: float | Quantity, speed: float | Quantity | None = None) -> np.ndarray:
        """No mass: it is the rotor's."""
        return np.zeros((self.frame.shape[1],) * 2)

    def G(self) -> np.ndarray:
        """No gyroscopic moment."""
        return np.zeros((self.frame.shape[1],) * 2)

    def save(self, file: str | Path) -> None:
        """Write the table over ``speeds`` as a ``BearingElement``, which ROSS reads without Raceway."""
        names = [f"{letter}{name}" for letter in "kc" for name in _ENTRIES]
        axes = {name: getattr(self, name) for name in ("speed", "frequency") if getattr(self, name, None) is not None}
        options = {name: getattr(self, name) for name in (*names, "n", "n_link", "tag", "scale_factor", "color")}
        _Element(**options, **axes).save(file)


def _radians(speed: float | Quantity) -> float:
    """Of a number, or of a quantity with a unit [rad/s]."""
    return float(speed.m_as("rad/s") if hasattr(speed, "m_as") else speed)
