"""One ball on one race of a B7206C, without the bearing around it."""

from typing import Any

import attrs
import numpy as np

from raceway import scene_from_dict
from raceway.core.contact.hertz import Ellipse
from raceway.core.fem.patches.patch import Patch, RingBody, Solid, Spacing, make_ball, make_patch
from raceway.core.fem.patches.pressure import Contact, ContactState
from raceway.extend import make_basis, resolve, ring_shape


@attrs.frozen(eq=False)
class Single:
    """A patch around a contact angle [rad], and the Hertz contact of half-spaces there."""

    patch: Patch
    ellipse: Ellipse
    angle: float

    @property
    def rest(self) -> float:
        """Distance of ball and groove centre at which they touch [m]."""
        return self.patch.race.groove - self.patch.ball.radius

    def place(self, approach: float, angle: float | None = None) -> np.ndarray:
        """(2,) of the ball at an approach [m] and a contact angle [rad]."""
        angle = self.angle if angle is None else angle
        return self.patch.race.sense * (self.rest + approach) * np.array([np.sin(angle), np.cos(angle)])

    def press(self, contact: Contact, approach: float, angle: float | None = None) -> ContactState:
        return contact.press(self.place(approach, angle), np.zeros(2))

    def at_load(self, load: float, law: Any = None) -> tuple[float, ContactState]:
        """Approach [m] and answer under a load [N], by Newton from Hertz's approach."""
        contact = Contact(self.patch, law)
        approach = float(self.ellipse.approach(load))
        normal = self.place(0.0) / self.rest
        for _ in range(30):
            pressed = self.press(contact, approach)
            change = (load + float(normal @ pressed.force)) / float(normal @ pressed.stiffness @ normal)
            approach += change
            if abs(change) < 1e-10 * approach:
                break
        return approach, self.press(contact, approach)

    def peak(self, pressed: ContactState) -> float:
        """Largest pressure at a point [Pa]."""
        return float(pressed.load.max() / self.patch.area)


def single(
    points: float, load: float, inner: bool = True, angle: float | None = None, room: float = 1.2, shear: bool = False
) -> Single:
    """A patch with so many points along each semi-axis at a load [N].

    angle : of the contact [rad]; the free contact angle when None
    room : how much further than the ellipse the points reach, as a factor
    shear : with compliances along the groove, for friction
    """
    scene = scene_from_dict({"title": "single contact", "bearing": {"preset": "B7206C"}})
    bearing, basis = scene.bearing, make_basis(resolve(scene))
    radius, shape = 0.5 * bearing.ball_diameter, ring_shape(bearing, inner)
    ellipse = basis.inner if inner else basis.outer
    angle = bearing.contact_angle if angle is None else angle
    a, b = (float(axis) for axis in ellipse.semi_axes(load))
    spacing = Spacing.of((a, b), points, radius, room * b)
    half = room * a / radius + 1.5 * spacing.along / radius
    solid = Solid(bearing.rings.young, bearing.rings.poisson)
    ring = RingBody(shape, solid, "clamped", (angle - half, angle + half))
    ball = make_ball(
        radius, Solid(bearing.balls.young, bearing.balls.poisson), spacing, int(2.0 * half * radius / spacing.along) + 3,
        shear,
    )  # fmt: skip
    return Single(make_patch(ring, ball, spacing, bearing.ball_count), ellipse, angle)
