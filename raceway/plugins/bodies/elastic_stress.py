"""Elastic bodies with pressures at surface points, and stresses below the most loaded contact of each race, beside Hertz's."""

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, Told, overlap
from raceway.core.contact.hertz import largest_shear
from raceway.core.fem.elastic.contact import NodalContact
from raceway.core.fem.elastic.ring import ElasticRing
from raceway.core.fem.elastic.stress import ContactAxis, StressProfile, contact_axes, stress_profile
from raceway.plugins.bodies.elastic_contacts import ElasticBodies, at_equilibrium
from raceway.storage.tables import Tables

#: Elements down to Hertz's depth, and along each semi-axis of the ellipse, from which a mesh counts as resolving the stresses.
_RESOLVED = 4.0
#: Elements within so many major semi-axes of a contact are looked at; the line ends at so many of Hertz's depths.
_NEAR, _DEEP = 1.5, 3.0
#: Points in a loaded contact below which its pressure is off by tens of percent.
_FEW_POINTS = 60


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


def below_contacts(bodies: "ElasticPoints", model: Model, equilibrium: Equilibrium) -> list[BelowContact]:
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
        sides = (("ball", ball + 2, lines[0], setup.balls), ("ring", race, lines[1], setup.rings))
        for body, index, axis, material in sides:
            depth = largest_shear((major, minor), peak, material[1])[1]
            u = moved[assembly.part(index)].reshape(-1, 3)
            deep = _DEEP * max(depth, 0.1 * minor)
            profile = stress_profile(axis, assembly.bodies[index].operator, u, _NEAR * major, deep)
            profiles.append(BelowContact(word, body, ball, index, load, peak, (major, minor), material[1], axis, profile))
    return profiles


def peak_at_points(contact: NodalContact) -> np.ndarray:
    """(pairs,) largest pressure at a quadrature point [Pa], at the last gaps."""
    return np.maximum.reduceat(contact.pressure, contact.starts)


def peak_at_nodes(contact: NodalContact) -> np.ndarray:
    """(pairs,) largest nodal pressure [Pa]: force of the points around a node over their area, as facets share them."""
    out = np.empty(len(contact.pairs))
    for index, (pair, begin) in enumerate(zip(contact.pairs, contact.starts, strict=True)):
        part = slice(begin, begin + contact.counts[index])
        _, number = np.unique(pair.points.nodes, return_inverse=True)
        share = contact.area[part, None] * pair.points.weights
        area = np.bincount(number.ravel(), share.ravel())
        force = np.bincount(number.ravel(), (contact.pressure[part, None] * share).ravel())
        out[index] = (force / area).max()
    return out


@attrs.frozen(eq=False)
class ElasticPoints(ElasticBodies):
    """Pressures at points."""

    #: By displacement: asked for five times a result, each an evaluation of all bodies.
    _columns: dict[bytes, dict[str, np.ndarray]] = attrs.field(init=False, factory=dict)

    @property
    def contact(self) -> NodalContact:
        contact = self.bearing.system.contact
        assert isinstance(contact, NodalContact)
        return contact

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        key = equilibrium.displacement.tobytes()
        if key in self._columns:
            return dict(self._columns[key])
        at_equilibrium(model.system)
        contact = self.contact
        out, z = super().ball_columns(model, equilibrium), model.system.ball_count
        table = {
            "peak_pressure_points_{}_pa": peak_at_points(contact),
            "peak_pressure_nodal_{}_pa": peak_at_nodes(contact),
            "points_{}": np.add.reduceat((contact.pressure > 0.0).astype(float), contact.starts),
            "approach_penetration_{}_m": np.maximum(-contact.deepest(), 0.0),
        }
        for race, word in enumerate(("inner", "outer")):
            out |= {name.format(word): values[race * z : (race + 1) * z] for name, values in table.items()}
        self._columns[key] = out
        return dict(out)

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """The overlap that a law leaves."""
        return overlap(self.ball_columns(model, equilibrium), equilibrium)

    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        columns = self.ball_columns(model, equilibrium)
        loaded = equilibrium.contact_force > 0.0
        approach, penetration = (
            np.concatenate([columns[f"{name}_{word}_m"] for word in ("inner", "outer")])[loaded]
            for name in ("approach", "approach_penetration")
        )
        share = penetration / np.maximum(approach, 1e-300) if loaded.any() else np.zeros(1)
        return {
            "bodies": "elastic: every node of rings and balls, pressures at surface points",
            "max_penetration_m": float(penetration.max(initial=0.0)),
            "penetration_share": float(share.max()),
            "subsurface": [profile.table() for profile in below_contacts(self, model, equilibrium)],
        }

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Contacts with too few points for their pressure; elements that lock."""
        sentences: list[str] = []
        columns = self.ball_columns(model, equilibrium)
        z = model.system.ball_count
        force = equilibrium.contact_force
        carries = force > 0.05 * force.max(initial=1e-300)
        least = min(
            columns[f"points_{word}"][carries[part]].min(initial=np.inf)
            for word, part in (("inner", slice(0, z)), ("outer", slice(z, 2 * z)))
        )
        if least < _FEW_POINTS:
            sentences.append(
                f"only {least:.0f} surface points carry a loaded contact: its pressure and the displacement depend on the mesh; "
                "take more mesh.nodes_per_semi_axis, with azimuth_cells = 'graded', or bodies.kind = 'condensed'"
            )
        return sentences + super().warnings(model, equilibrium)
