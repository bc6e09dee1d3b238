"""Interpolation of a table of coefficients by ROSS 2, and tables that pass through the points there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


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
