"""Extent of contacts: windows of contact angles, and the widest ellipse."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.contact.hertz import Ellipse
from raceway.core.patches.contact import BeyondPatch
from raceway.errors import ConvergenceError

#: Room on each side of a window [rad], and around an ellipse, of its semi-axes.
MARGIN, AROUND = np.deg2rad(0.7), 1.15

Window = tuple[float, float]


@attrs.frozen
class Reach:
    """Extent that patches have to cover.

    Attributes
    ----------
    inner, outer : lowest and highest angle of points in contact [rad]
    widest : largest minor semi-axis, with room [m]
    mean_load, largest_load : of the balls that carry, on the inner race, and of all contacts [N]
    """

    inner: Window
    outer: Window
    widest: float
    mean_load: float
    largest_load: float

    def grown(self, left: BeyondPatch, ellipse: Ellipse, radius: float, room: float) -> Reach:
        """One that holds a contact which left this one, by a clear step at least.

        Raises
        ------
        ConvergenceError
            A contact as large as the ball: what runs away is not meshed.
        """
        load = max(self.largest_load, left.load) * (room if left.across else 1.0)
        a, b = ellipse.semi_axes(load)
        if not max(a, b) < radius:
            raise ConvergenceError(f"the balls run away from the races: {left}, on an ellipse as large as the ball")
        old = self.inner if left.sense < 0.0 else self.outer
        half = AROUND * float(a) / radius + 3.0 * MARGIN
        window = _rounded(min(old[0], left.angle - half), max(old[1], left.angle + half))
        if not left.across and window == old:
            window = (old[0] - 3.0 * MARGIN, old[1] + 3.0 * MARGIN)
        widest = max(self.widest, AROUND * float(b))
        if left.across and widest == self.widest:
            widest *= room
        inner, outer = (window, self.outer) if left.sense < 0.0 else (self.inner, window)
        return Reach(inner, outer, widest, self.mean_load, load)


def _rounded(low: float, high: float) -> Window:
    """Outwards to whole degrees, so that states near each other share their compliances."""
    return float(np.deg2rad(np.floor(np.rad2deg(low) + 1e-6))), float(np.deg2rad(np.ceil(np.rad2deg(high) - 1e-6)))


def reach_of(
    inner: tuple[np.ndarray, np.ndarray],
    outer: tuple[np.ndarray, np.ndarray],
    ellipses: tuple[Ellipse, Ellipse],
    radius: float,
    free: float,
    room: float,
) -> Reach:
    """Reach of known contacts.

    Parameters
    ----------
    inner, outer : angles (n,) [rad] and loads (n,) [N]
    radius : of the ball [m];  free : contact angle where nothing carries [rad];  room : more load than known, as a factor
    """
    windows, widest, largest = [], 0.0, 0.0
    for (angle, load), ellipse in zip((inner, outer), ellipses, strict=True):
        heaviest = max(float(load.max()), 1.0)
        a, b = ellipse.semi_axes(room * heaviest)
        carrying = load > 1e-3 * heaviest
        known = angle[carrying] if carrying.any() else np.array([free])
        half = AROUND * float(a) / radius + MARGIN
        windows.append(_rounded(float(known.min()) - half, float(known.max()) + half))
        widest, largest = max(widest, AROUND * float(b)), max(largest, heaviest)
    carrying = inner[1] > 0.1 * max(float(inner[1].max()), 1.0)
    mean = float(inner[1][carrying].mean()) if carrying.any() else largest
    return Reach(windows[0], windows[1], widest, mean, largest)
