"""Finite elements of a ring against Hertz: the approach that a footprint of their mesh takes, calibrated over loads."""

import attrs
import numpy as np

from raceway.core.contact.hertz import Ellipse
from raceway.core.fem.patches.patch import Patch, RingBody, Solid, Spacing, make_ball, make_patch
from raceway.core.fem.patches.pressure import BeyondPatch, Contact
from raceway.core.fem.revolution.sections import coarse_profile
from raceway.errors import ConvergenceError, MeshError
from raceway.storage.array_cache import kept

#: Points along a semi-axis of the coarser and the finer patch.
POINTS = (3, 6)

#: Loads over the typical one.
LOADS = np.linspace(0.4, 1.6, 25)

#: How much further than the typical ellipse points reach: 1.17 at the largest load, the rest for patches' ends.
_ROOM = 1.4

#: Distance of the finer patch from the limit, over Hertz's approach, above which points tell nothing.  They are apart by 0.4 %;
#: rings 1e6 times as stiff as steel on a soft bed lose more to rounding.
_TELLS = 0.01

#: How far up the groove the second contact is [rad].
_FURTHER = 0.15

_ITERATIONS = 30


@attrs.frozen(eq=False)
class Calibration:
    """Of contacts on one race."""

    angles: np.ndarray  # (n,) contact angles [rad], ascending
    compliance: np.ndarray  # (n,) of ring and ball together, beyond Hertz: tangent, d(approach - Hertz's) / dQ [m/N]
    #: how well it is known: what was still to come beyond the finer patch, and the standard deviation of its mean [m/N]
    uncertainty: float
    trend: float  # change of (approach - Hertz's) / Q with the logarithm of the load, which is left out [m/N]
    load: float  # where the compliance holds [N]

    def error(self, load: np.ndarray) -> np.ndarray:
        """(...) error of the secant or the tangent compliance at other loads [N], the larger one [m/N]."""
        away = np.log(load / self.load)
        return self.uncertainty + self.trend * np.maximum(np.abs(1.0 - away), np.abs(away))


def calibrated(
    body: RingBody, ball: Solid, ellipses: tuple[Ellipse, Ellipse], load: float, radius: float, balls: int, angle: float
) -> Calibration | None:
    """Of contacts on a ring, at the free contact angle and some way up the groove; None where points determine nothing.

    body : the ring, its window is not used;  ellipses : Hertz's contacts of both races, whose points have the same distances
    load : typical one [N];  radius : of the ball [m];  balls : in a row;  angle : free contact angle [rad]

    Depth matching (``structural``) compares fields on the normal through the centre of a contact. The compliance of a
    contact that is long against the wall below it is their mean over its length, which is less; nor is a groove a
    paraboloid. One ball on one race, solved at its surface points, has both effects: (approach - Hertz's) / load as a
    function of the load. Its error falls with the square of the distance of points, so that two distances give the limit; a
    mean over loads removes the ripple of points that come and go.
    """
    profile = coarse_profile(body.shape, body.solid.bulk, body.solid.bulk)
    inputs: dict[str, object] = {
        "points": profile.points, "seat_nodes": profile.seat, "inner": body.shape.inner, "groove": body.shape.groove,
        "centre": [body.shape.centre_r, body.shape.centre_x], "seat": body.seat, "load": load, "radius": radius,
        "balls": balls, "angle": angle, "solids": [*attrs.astuple(body.solid), *attrs.astuple(ball)],
        "ellipses": [[*(float(axis) for axis in contact.semi_axes(1.0)), float(contact.factor)] for contact in ellipses],
    }  # fmt: skip

    def make() -> dict[str, np.ndarray]:
        calibration = []
        for contact_angle in (angle, angle + _FURTHER):
            loaded = _Loaded(load, radius, balls, contact_angle)
            try:
                calibration.append([_compliances(body, ball, ellipses, n, loaded) for n in POINTS])
            except (BeyondPatch, ConvergenceError, MeshError):
                break
        return {"compliance": np.array(calibration)}

    word = "inner" if body.shape.inner else "outer"
    values = kept("contact", f"one ball on the {word} ring, {POINTS[1]} points", inputs, SOURCES, make)["compliance"]
    if not values.size:
        return None
    calibration = _limit(values, angle, load)
    ellipse = ellipses[0 if body.shape.inner else 1]
    return calibration if calibration.uncertainty <= _TELLS * float(ellipse.approach(load)) / load else None


def _limit(values: np.ndarray, angle: float, load: float) -> Calibration:
    """Of values (angles, 2, loads) of the coarser and the finer patch."""
    ratio, logs = (POINTS[1] / POINTS[0]) ** 2, np.log(LOADS)
    limit = (ratio * values[:, 1] - values[:, 0]) / (ratio - 1.0)
    trends, secant = np.polyfit(logs, limit.T, 1)
    trend = float(trends.mean())
    scatter = (limit - secant[:, None] - trend * logs).std(axis=1) / np.sqrt(len(LOADS))
    remainder = np.abs(limit - values[:, 1]).mean(axis=1) + scatter
    angles = np.array([angle, angle + _FURTHER])[: len(limit)]
    return Calibration(angles, secant + trend, float(remainder.max()), abs(trend), load)


@attrs.frozen
class _Loaded:
    """A largest load of a ball [N], the ball's radius [m], the count of balls, and the contact angle [rad]."""

    load: float
    radius: float
    balls: int
    angle: float


def _compliances(body: RingBody, solid: Solid, ellipses: tuple[Ellipse, Ellipse], nodes: int, at: _Loaded) -> np.ndarray:
    """(loads,) with so many points along a semi-axis of the inner contact [m/N]."""
    load, radius, balls, angle = at.load, at.radius, at.balls, at.angle
    axes = np.array([ellipse.semi_axes(load) for ellipse in ellipses], dtype=float)
    widest = _ROOM * axes.max(axis=0)
    spacing = Spacing.of((float(axes[0, 0]), float(axes[0, 1])), nodes, radius, float(widest[1]))
    half = float(widest[0]) / radius + 1.5 * spacing.along / radius
    ring = attrs.evolve(body, window=(angle - half, angle + half))
    ball = make_ball(radius, solid, spacing, int(2.0 * half * radius / spacing.along) + 3)
    patch, ellipse = make_patch(ring, ball, spacing, balls), ellipses[0 if body.shape.inner else 1]
    contact = Contact(patch, None)
    return np.array([_compliance(contact, patch, ellipse, float(part * load), angle) for part in LOADS])


def _compliance(contact: Contact, patch: Patch, ellipse: Ellipse, load: float, angle: float) -> float:
    """(approach - Hertz's) / load under a load along the normal, by Newton from Hertz's approach [m/N]."""
    normal = patch.race.sense * np.array([np.sin(angle), np.cos(angle)])
    offset, hertz = patch.race.groove - patch.ball.radius, float(ellipse.approach(load))
    centre = (offset + hertz) * normal
    for _ in range(_ITERATIONS):
        state = contact.press(centre, np.zeros(2))
        change = np.linalg.solve(state.stiffness, load * normal + state.force)
        centre = centre + change
        if np.abs(change).max() < 1e-9 * hertz:
            if state.truncated:
                raise ConvergenceError("the groove's edge truncates the contact", {})
            return (float(normal @ centre) - offset - hertz) / load + float(normal @ patch.race.crossing[0] @ normal)
    raise ConvergenceError("the approach of a single contact did not converge", {"place": centre})


#: Sources on which kept numbers depend.
SOURCES = ("core/fem/revolution", "core/fem/hexahedron", "core/fem/structural.py", "core/fem/patches", "core/fem/mesh")
