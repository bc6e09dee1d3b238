"""What a result tells of elastic bodies that touch at points of their surfaces: pressures, stresses below, and the overlap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.contact_error import overlap
from raceway.bodies.elastic.report import ElasticBodies
from raceway.bodies.elastic.subsurface import below_contacts
from raceway.bodies.model import Told
from raceway.elastic.contact import deepest_penetration, peak_at_nodes, peak_at_points, points_in_contact
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model

#: Points in a loaded contact below which its pressure is off by tens of percent.
_FEW_POINTS = 60


@attrs.frozen(eq=False)
class ElasticPoints(ElasticBodies):
    """Pressures at points."""

    #: By displacement: asked for five times a result, each an evaluation of all bodies.
    _columns: dict[bytes, dict[str, np.ndarray]] = attrs.field(init=False, factory=dict)

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        key = equilibrium.displacement.tobytes()
        if key not in self._columns:
            self._columns[key] = self._told(model, equilibrium)
        return dict(self._columns[key])

    def _told(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        system: Any = model.system
        system.in_place(system.equilibrium)
        contact: Any = self.bearing.system.contact
        out, z = super().ball_columns(model, equilibrium), model.system.ball_count
        found = {
            "peak_pressure_points_{}_pa": peak_at_points(contact),
            "peak_pressure_nodal_{}_pa": peak_at_nodes(contact),
            "points_{}": points_in_contact(contact).astype(float),
            "approach_penetration_{}_m": deepest_penetration(contact),
        }
        for race, word in enumerate(("inner", "outer")):
            out |= {name.format(word): values[race * z : (race + 1) * z] for name, values in found.items()}
        return out

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """The overlap that a law leaves."""
        return overlap(self.ball_columns(model, equilibrium), equilibrium)

    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        columns = self.ball_columns(model, equilibrium)
        loaded = equilibrium.contact_force > 0.0
        approach, left = (
            np.concatenate([columns[f"{name}_{word}_m"] for word in ("inner", "outer")])[loaded]
            for name in ("approach", "approach_penetration")
        )
        share = left / np.maximum(approach, 1e-300) if loaded.any() else np.zeros(1)
        return {
            "bodies": "elastic: every node of rings and balls, pressures at surface points",
            "max_penetration_m": float(left.max(initial=0.0)),
            "penetration_share": float(share.max()),
            "subsurface": [one.table() for one in below_contacts(self, model, equilibrium)],
        }

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Contacts with too few points for their pressure; elements that lock."""
        found: list[str] = []
        columns = self.ball_columns(model, equilibrium)
        z = model.system.ball_count
        force = equilibrium.contact_force
        carries = force > 0.05 * force.max(initial=1e-300)
        least = min(
            columns[f"points_{word}"][carries[part]].min(initial=np.inf)
            for word, part in (("inner", slice(0, z)), ("outer", slice(z, 2 * z)))
        )
        if least < _FEW_POINTS:
            found.append(
                f"only {least:.0f} surface points carry a loaded contact: its pressure and the displacement depend on the mesh; "
                "take more mesh.nodes_per_semi_axis, with azimuth_cells = 'graded', or bodies.kind = 'condensed'"
            )
        return found + super().warnings(model, equilibrium)
