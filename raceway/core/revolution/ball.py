"""The floating ball: its compliance without dimensions, so that one stored array serves every ball of a mesh and ratio.

A displacement u of a ball of radius R and Young's modulus E under a force F is c F / (E R), where c belongs to radius 1 and
modulus 1.  Rigid motions stand apart: c gives displacements relative to the mean motion of the ball's masses ("ball
centre"), under loads balanced by uniform acceleration, which for the ball's own balanced contacts is no load at all.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.revolution.ball_profile import ball_profile
from raceway.core.revolution.cached import cached_compliance
from raceway.core.revolution.profile import Profile, dofs

#: Digits kept of the mesh's dimensionless sizes, so that equal balls of unequal size find the same entry.
_DIGITS = 9


@attrs.frozen(eq=False)
class FreeBall:
    """Compliance of a floating ball between points near its equator.

    Attributes
    ----------
    divisions : sectors around the equator; one is an angle 2 pi / divisions of contact angle
    latitudes : (n,) float, of the surface nodes [rad], towards the rolling direction
    offsets : (o,) int, sectors from the loaded to the observed meridian
    components : of the rows and columns, one after the other: 0 r (outward), 1 theta, 2 x (rolling direction)
    dimensionless : (o, len(components) n, len(components) n) float, u E R / F
    elements : hexahedra that the ball stands for
    """

    divisions: int
    latitudes: np.ndarray
    offsets: np.ndarray
    components: tuple[int, ...]
    dimensionless: np.ndarray
    elements: int

    def compliance(self, radius: float, young: float) -> np.ndarray:
        """(o, observed, loads) of a ball of that radius [m] and modulus [Pa], in m/N."""
        return np.asarray(self.dimensionless / (radius * young))


def free_ball(
    radius: float,
    poisson: float,
    divisions: int,
    lateral_step: float,
    half_width: float,
    depth_step: float,
    bulk: float,
    offsets: np.ndarray,
    components: tuple[int, ...] = (0, 2),
    formulation: str = "incompatible",
    harmonics: str = "all",
) -> FreeBall:
    """The floating ball of a mesh, from the cache where it is there.

    Parameters
    ----------
    radius : float [m]
    divisions : int
        Sectors around the equator.
    lateral_step, half_width : float
        Distance of the nodes along the rolling direction, and up to where, as arc lengths [m].
    depth_step, bulk : float
        First layer below the surface, and elements far from it [m].
    offsets : (o,) int
        Sectors from the loaded to the observed meridian; the opposite pole lies divisions / 2 away.
    harmonics : str
        A ball has but some hundred harmonics, and it is coarsest around its equator, where sampling is least exact.
    """
    sizes = [round(length / radius, _DIGITS) for length in (lateral_step, half_width, depth_step, bulk)]
    profile: Profile = ball_profile(1.0, *sizes)
    degrees = dofs(profile.race, components)
    steps = np.asarray(offsets, dtype=np.int64)
    elements = len(profile.quads) * divisions
    found = cached_compliance(
        f"ball, {divisions} x {len(profile.quads)} elements, Poisson's ratio {poisson:g}",
        profile,
        divisions,
        1.0,
        poisson,
        degrees,
        degrees,
        steps,
        formulation,
        "free",
        harmonics,
    )
    return FreeBall(divisions, profile.angles, steps, tuple(components), found, elements)
