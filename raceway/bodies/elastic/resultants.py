"""What a result tells of elastic bodies with a calibrated force a contact: what was taken off the mesh, and how sure that is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.condensed.calibration_error import calibration_error
from raceway.bodies.contact_error import untold
from raceway.bodies.elastic.report import ElasticBodies
from raceway.bodies.model import Told
from raceway.framework.estimate import Estimate
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.structural import ElasticBodies as Compliances

#: Turn of a contact [rad] that puts it a quarter of its ellipse away from where the mesh was asked: the local compliance there is
#: another by 0.5 % of a contact's, measured on elements of 3.2 mm.
_FAR_RAD = 0.05
#: Share of a contact's compliance that may be uncertain before a finer mesh is asked for.
_UNSURE = 0.0125


@attrs.frozen(eq=False)
class ElasticResultants(ElasticBodies):
    """A force for each ball and race.

    Attributes
    ----------
    compliances : of the bearing's own rings and balls, which tell how contacts at surface points calibrate the law
    """

    compliances: Compliances

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        contact: Any = self.bearing.system.contact
        out, z = super().ball_columns(model, equilibrium), model.system.ball_count
        for race, word in enumerate(("inner", "outer")):
            part = slice(race * z, (race + 1) * z)
            out[f"approach_replaced_{word}_m"] = contact.local[part] * equilibrium.contact_force[part]
        return out

    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        contact: Any = self.bearing.system.contact
        z, beyond = model.system.ball_count, self.bearing.setup.beyond
        assert beyond is not None
        return {
            "bodies": "elastic: every node of rings and balls, contacts as resultants calibrated to Hertz",
            "mesh": {
                "replaced_inner_m_per_n": float(contact.local[:z].mean()),
                "replaced_outer_m_per_n": float(contact.local[z:].mean()),
                "calibration_inner_m_per_n": float(np.mean(beyond[:z])),
                "calibration_outer_m_per_n": float(np.mean(beyond[z:])),
                "replaced_spread_m_per_n": float(max(one.spread for one in contact.touches)),
                "replaced_uncertainty": self._uncertainty(model, equilibrium),
                "largest_turn_deg": float(np.degrees(self._turned(model, equilibrium))),
            },
        }

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Meshes that do not tell the contacts' compliance from the bodies', contacts that moved away; elements that lock."""
        found = []
        unsure = self._uncertainty(model, equilibrium)
        if unsure > _UNSURE:
            found.append(
                f"the mesh is too coarse to tell its own compliance under a contact to better than {100 * unsure:.2g} % of the "
                "contact's: take a smaller mesh.element_size, or bodies.kind = 'condensed'"
            )
        turned = self._turned(model, equilibrium)
        if turned > _FAR_RAD:
            found.append(
                f"a contact angle lies {np.degrees(turned):.2g} deg from that with rigid bodies, where the mesh's own compliance "
                "was looked at: compare with bodies.kind = 'condensed', which follows the angle"
            )
        return found + super().warnings(model, equilibrium)

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Of a ball's stiffness by what the calibration leaves, and by how well the mesh knows what is taken off."""
        if not model.traits.calibrated:
            return untold(model)
        contact: Any = self.bearing.system.contact
        spread = 0.5 * max(float(one.spread) for one in contact.touches)
        size, how = calibration_error(self.compliances, model, equilibrium, spread)
        return size, how if size is None else Estimate.CALIBRATED_ON_MESH()

    def _uncertainty(self, model: Model, equilibrium: Equilibrium) -> float:
        """Half the spread over depths of what is taken off, over the compliance of the most loaded contact."""
        contact: Any = self.bearing.system.contact
        worst = int(np.argmax(equilibrium.contact_force))
        if equilibrium.contact_force[worst] <= 0.0:
            return 0.0
        system: Any = model.system
        system.in_place(system.equilibrium)
        compliance = contact.local[worst] - 1.0 / contact.d_gap[worst]  # the law's own
        return float(0.5 * contact.touches[worst].spread / compliance)

    def _turned(self, model: Model, equilibrium: Equilibrium) -> float:
        """Largest angle between a loaded contact's line and that at which its footprints lie [rad]."""
        angles = self.bearing.setup.angles
        assert angles is not None
        found = np.concatenate([equilibrium.angle_inner, equilibrium.angle_outer])
        loaded = equilibrium.contact_force > 0.0
        return float(np.abs(found - angles)[loaded].max(initial=0.0))
