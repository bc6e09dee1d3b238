"""Stresses below the most loaded contact of each race, in ball and ring, beside Hertz's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.contact.hertz import largest_shear
from raceway.core.fem.elastic.ring import ElasticRing
from raceway.core.fem.elastic.stress import ContactAxis, StressProfile, contact_axes, stress_profile
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.plugins.bodies.elastic_contacts import ElasticPoints

#: Elements down to Hertz's depth, and along each semi-axis of the ellipse, from which a mesh counts as resolving the stresses.
_RESOLVED = 4.0
#: Elements within so many major semi-axes of a contact are looked at; the line ends at so many of Hertz's depths.
_NEAR, _DEEP = 1.5, 3.0


@attrs.frozen(eq=False)
class BelowContact:
    """One side of the most loaded contact of a race.

    Attributes
    ----------
    race : "inner" or "outer";  body : "ball" or "ring";  ball : its number;  index : of the body in the assembly
    load : of the contact [N];  peak_pressure : Hertz's at that load [Pa];  semi_axes : major, minor [m];  poisson : of the body
    axis : ContactAxis;  profile : StressProfile
    """

    race: str
    body: str
    ball: int
    index: int
    load: float
    peak_pressure: float
    semi_axes: tuple[float, float]
    poisson: float
    axis: ContactAxis
    profile: StressProfile

    @property
    def hertz(self) -> tuple[float, float]:
        """Largest shear stress [Pa] and its depth [m] by Hertz at the same load."""
        return largest_shear(self.semi_axes, self.peak_pressure, self.poisson)

    @property
    def cells(self) -> tuple[float, float, float]:
        """Elements down to Hertz's depth, along the major and along the minor semi-axis of the ellipse."""
        across, rolling = (float(x) for x in self.semi_axes / self.profile.lengths[0, :2])
        return self.profile.cells_to(self.hertz[1]), across, rolling

    @property
    def resolved(self) -> bool:
        """Whether the mesh resolves the stresses."""
        return min(self.cells) >= _RESOLVED

    def table(self) -> Tables:
        """Plain numbers, for result.json."""
        (shear, depth), (hertz, hertz_depth) = self.profile.largest(), self.hertz
        down, across, rolling = self.cells
        return {
            "race": self.race,
            "body": self.body,
            "ball": self.ball,
            "load_n": self.load,
            "largest_shear_pa": shear,
            "depth_m": depth,
            "hertz_largest_shear_pa": hertz,
            "hertz_depth_m": hertz_depth,
            "cells_to_hertz_depth": down,
            "cells_per_semi_major": across,
            "cells_per_semi_minor": rolling,
            "resolved": self.resolved,
        }


def below_contacts(bodies: ElasticPoints, model: Model, equilibrium: Equilibrium) -> list[BelowContact]:
    """Ball and ring below the most loaded contact of each race, at rest; none of a race that carries nothing."""
    system = model.system
    assert isinstance(system, ElasticRing)
    system.in_place(system.equilibrium)
    setup, assembly, contact = bodies.bearing.setup, bodies.bearing.system.assembly, bodies.contact
    moved = assembly.nodal(system.equilibrium)
    z, profiles = model.system.ball_count, []
    for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
        loads = equilibrium.contact_force[race * z : (race + 1) * z]
        ball = int(np.argmax(loads))
        centre = 0.5 * setup.geometry.pitch_diameter * setup.radial(ball)
        lines = contact_axes(contact, race * z + ball, centre, setup.turn(ball)[:, 2]) if loads[ball] > 0.0 else None
        if lines is None:
            continue
        load = float(loads[ball])
        major, minor = (float(x) for x in ellipse.semi_axes(load))
        peak = float(ellipse.peak_pressure(load))
        for body, index, axis, material in (
            ("ball", ball + 2, lines[0], setup.balls),
            ("ring", race, lines[1], setup.rings),
        ):
            depth = largest_shear((major, minor), peak, material[1])[1]
            u = moved[assembly.part(index)].reshape(-1, 3)
            deep = _DEEP * max(depth, 0.1 * minor)
            profile = stress_profile(axis, assembly.bodies[index].operator, u, _NEAR * major, deep)
            profiles.append(BelowContact(word, body, ball, index, load, peak, (major, minor), material[1], axis, profile))
    return profiles
