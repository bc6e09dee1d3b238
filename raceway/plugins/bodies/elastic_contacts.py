"""What a result tells of elastic bodies, whatever their contacts: reactions, energies, mesh, and the balance of forces."""

import itertools
from abc import abstractmethod
from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.contacts import rigid_rings
from raceway.bodies.model import BuiltBearing, Equilibrium, Model, Told, calibration_error, untold
from raceway.core.fem.elastic import ring as start
from raceway.core.fem.elastic.bearing import ElasticBearing
from raceway.core.fem.elastic.resultant import ResultantContact
from raceway.core.fem.elastic.ring import ElasticRing
from raceway.core.fem.structural import ElasticBodies as Compliances
from raceway.core.record import Motion
from raceway.core.ring.orbit import Orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System, surrogate
from raceway.framework.estimate import Estimate
from raceway.plugins.bodies.mesh import locking
from raceway.storage.tables import Tables


@attrs.frozen(eq=False)
class ElasticBodies(BuiltBearing):
    """Rings and balls of which every node moves.

    Attributes
    ----------
    bearing : ElasticBearing
    rigid : the same scene with rigid bodies and contact resultants
    """

    bearing: ElasticBearing
    rigid: System

    @property
    def foreseen(self) -> System:
        """The same ring with rigid bodies: elastic ones would iterate for minutes."""
        return surrogate(self.system)

    def solve_equilibrium(
        self, near: np.ndarray | None = None, on_progress: Callable[[str, int, int], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Newton's iteration over all nodes."""
        if on_progress is not None:
            report, count = on_progress, itertools.count(1)
            system = self.bearing.system
            system.on_residual = lambda residual: report(f"equilibrium, residual {residual:.1e}", next(count), 0)
            if system.condensed is not None:
                system.condensed.on_progress = report
        return super().solve_equilibrium()

    def periodic_system(self, system: Ring) -> Ring:
        """The rigid one: periodic motions of all nodes would take hours."""
        return surrogate(system).at_standstill()

    def on_orbit(self, system: Ring, orbit: Orbit, dt: float) -> Motion:
        """Near the orbit of rigid bodies."""
        return start.from_orbit(_elastic(system), orbit)

    def at_rest(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """All nodes at rest."""
        return start.standstill(_elastic(system), ramped)

    def at_equilibrium(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """All nodes in balance."""
        return start.static_orbit(_elastic(system), ramped)

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,).

        The approach of a contact, that of the ball's centre to the groove where the rigid frame of its ring has it, is
        Hertz's at its load, and the rest: finite bodies, the mesh, and what a penalty lets overlap.
        """
        z, out = model.system.ball_count, {}
        centre = model.system.centre_vectors(equilibrium.displacement)[0]
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            away = centre - equilibrium.ball if race == 0 else equilibrium.ball
            offset = model.geometry.offset_inner if race == 0 else model.geometry.offset_outer
            load = equilibrium.contact_force[race * z : (race + 1) * z]
            out[f"approach_{word}_m"] = np.where(load > 0.0, np.linalg.norm(away, axis=1) - offset, 0.0)
            out[f"approach_hertz_{word}_m"] = np.asarray(ellipse.approach(load))
        return out

    @abstractmethod
    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """What ``report`` says of the contacts; ``mesh`` there is added to what it says of the mesh."""

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json."""
        contacts = self.contact_table(model, equilibrium)
        y, bodies = _elastic(model.system).equilibrium, self.bearing.system
        a = bodies.assembly
        cage = np.zeros(self.bearing.ball_count) if a.cage is None else a.cage.force(a.nodal(y))[::4]  # along the orbit [N]
        across = np.stack([self.bearing.setup.turn(k)[:, 2] for k in range(len(cage))])
        force = a.reactions(y) - cage @ across  # the ideal cage stands on the ground
        energies = bodies.energies(y, np.zeros_like(y)) | {"external": float(bodies.load @ y)}
        return {
            "rigid_rings": rigid_rings(self.rigid, self.guess)[0],
            "mesh": {
                "cells": self.bearing.cells,
                "nodes": bodies.assembly.nodes,
                "unknowns": bodies.size,
                "formulation": model.problem.bodies.formulation,
                "hourglass_coefficient": model.problem.bodies.hourglass
                if model.problem.bodies.formulation == "one_point"
                else None,
                **contacts.pop("mesh", {}),
            },
            "reaction_n": dict(zip("xyz", force.tolist(), strict=True)),
            "unbalanced_n": float(np.abs((force + model.system.load[:3]) * model.system.free[:3]).max()),
            "cage_force_n": float(np.abs(cage).max()),
            "energies_j": energies,
            "hourglass_energy_ratio": energies["hourglass"] / max(energies["elastic"], 1e-300),
            **contacts,
            **({"mass_scaling": self._mass_scaling()} if bodies.assembly.added_mass.any() else {}),
            "linear_solver": {
                "iterations": bodies.solver.iterations,
                "solves": bodies.solver.solves,
                "setups": bodies.solver.setups,
            },
        }

    def _mass_scaling(self) -> Tables:
        """By body: elements with added mass, its sum, its share; what the ring gains as a rigid body, and steps by elements and contacts."""
        system = self.bearing.system
        a, contact = system.assembly, system.contact
        assert contact is not None
        added = np.add.reduceat(a.added_mass, a.starts[:-1]), np.add.reduceat(a.node_mass, a.starts[:-1])
        moving = added[0].sum() - added[0][1], added[1].sum() - added[1][1]  # all but the outer ring
        gain = a.added_inertia().diagonal().tolist()
        return {
            "bodies": {
                body.name: {
                    "elements": int((body.operator.mass_factors > 1.0).sum()),
                    "added_kg": float(more),
                    "share": float(more / (mass - more)),
                }
                for body, more, mass in zip(a.bodies, *added, strict=True)
            },
            "moving_share": float(moving[0] / (moving[1] - moving[0])),
            "ring_gains": dict(zip(("x_kg", "y_kg", "z_kg", "tilt_y_kgm2", "tilt_z_kgm2"), gain, strict=True)),
            "stable_step_s": {"elements": system.element_step(), "contacts": contact.stable_step(a.node_mass)},
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        """Not estimated: a second mesh costs more than the run."""
        return None, Estimate.FINER_MESH()

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Elements that lock."""
        return locking(model.problem, model.problem.bodies.formulation == "one_point")


def _elastic(system: Ring) -> ElasticRing:
    assert isinstance(system, ElasticRing)
    return system


def at_equilibrium(system: Ring) -> None:
    """The bodies keep the contacts of the equilibrium."""
    ring = _elastic(system)
    ring.in_place(ring.equilibrium)


#: Turn of a contact [rad] that puts it a quarter of its ellipse away from where the mesh was asked: the local compliance there is
#: another by 0.5 % of a contact's, measured on elements of 3.2 mm.
_FAR_RAD = 0.05
#: Share of a contact's compliance that may be uncertain before a finer mesh is asked for.
_UNSURE = 0.0125


@attrs.frozen(eq=False)
class ElasticResultants(ElasticBodies):
    """A force for each ball and race."""

    #: of the bearing's own rings and balls, for the calibration of the law by contacts at surface points
    compliances: Compliances

    @property
    def contact(self) -> ResultantContact:
        contact = self.bearing.system.contact
        assert isinstance(contact, ResultantContact)
        return contact

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        contact = self.contact
        out, z = super().ball_columns(model, equilibrium), model.system.ball_count
        for race, word in enumerate(("inner", "outer")):
            part = slice(race * z, (race + 1) * z)
            out[f"approach_replaced_{word}_m"] = contact.local[part] * equilibrium.contact_force[part]
        return out

    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        contact = self.contact
        z, beyond = model.system.ball_count, self.bearing.setup.beyond
        assert beyond is not None
        return {
            "bodies": "elastic: every node of rings and balls, contacts as resultants calibrated to Hertz",
            "mesh": {
                "replaced_inner_m_per_n": float(contact.local[:z].mean()),
                "replaced_outer_m_per_n": float(contact.local[z:].mean()),
                "calibration_inner_m_per_n": float(np.mean(beyond[:z])),
                "calibration_outer_m_per_n": float(np.mean(beyond[z:])),
                "replaced_spread_m_per_n": float(max(touch.spread for touch in contact.touches)),
                "replaced_uncertainty": self._uncertainty(model, equilibrium),
                "largest_turn_deg": float(np.degrees(self._turned(equilibrium))),
            },
        }

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Meshes that do not separate the contacts' compliance from the bodies', contacts that moved away; elements that lock."""
        sentences = []
        unsure = self._uncertainty(model, equilibrium)
        if unsure > _UNSURE:
            sentences.append(
                f"the mesh is too coarse to determine its compliance below a contact to better than {100 * unsure:.2g} % of the "
                "contact's: use a smaller mesh.element_size, or bodies.kind = 'condensed'"
            )
        turned = self._turned(equilibrium)
        if turned > _FAR_RAD:
            sentences.append(
                f"a contact angle lies {np.degrees(turned):.2g} deg from that with rigid bodies, at which the mesh compliance "
                "was computed: compare with bodies.kind = 'condensed', which depends on the angle"
            )
        return sentences + super().warnings(model, equilibrium)

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Of a ball's stiffness by what the calibration leaves, and by how well the mesh knows what is taken off."""
        if not model.traits.calibrated:
            return untold(model)
        spread = 0.5 * max(float(touch.spread) for touch in self.contact.touches)
        size, how = calibration_error(self.compliances, model, equilibrium, spread)
        return size, how if size is None else Estimate.CALIBRATED_ON_MESH()

    def _uncertainty(self, model: Model, equilibrium: Equilibrium) -> float:
        """Half the spread over depths of what is taken off, over the compliance of the most loaded contact."""
        contact = self.contact
        worst = int(np.argmax(equilibrium.contact_force))
        if equilibrium.contact_force[worst] <= 0.0:
            return 0.0
        at_equilibrium(model.system)
        compliance = contact.local[worst] - 1.0 / contact.d_gap[worst]  # the law's own
        return float(0.5 * contact.touches[worst].spread / compliance)

    def _turned(self, equilibrium: Equilibrium) -> float:
        """Largest angle between a loaded contact's line and that at which its footprints lie [rad]."""
        angles = self.bearing.setup.angles
        assert angles is not None
        present = np.concatenate([equilibrium.angle_inner, equilibrium.angle_outer])
        loaded = equilibrium.contact_force > 0.0
        return float(np.abs(present - angles)[loaded].max(initial=0.0))
