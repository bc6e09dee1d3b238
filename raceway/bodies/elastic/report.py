"""What a result tells of elastic bodies, whatever their contacts: reactions, energies, mesh, and the balance of forces."""

from __future__ import annotations

import itertools
from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.elastic.locking import locking
from raceway.bodies.model import Bearing
from raceway.core.record import Motion
from raceway.core.ring.orbit import Orbit
from raceway.core.ring.ring import COORDINATES, Ring
from raceway.core.ring.system import System, surrogate
from raceway.elastic import ring as start
from raceway.elastic.bearing import ElasticBearing
from raceway.elastic.ring import ElasticRing
from raceway.framework.estimate import Estimate
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model


@attrs.frozen(eq=False)
class ElasticBodies(Bearing):
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

    def settle(
        self, near: np.ndarray | None = None, on_progress: Callable[[str, int, int], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Newton's iteration over all nodes."""
        if on_progress is not None:
            told, count = on_progress, itertools.count(1)
            system = self.bearing.system
            system.on_residual = lambda residual: told(f"equilibrium, residual {residual:.1e}", next(count), 0)
            if system.condensed is not None:
                system.condensed.on_progress = told
        return super().settle()

    def orbiting(self, system: Ring) -> Ring:
        """The rigid one: periodic motions of all nodes would take hours."""
        return surrogate(system).at_standstill()

    def on_orbit(self, system: Ring, orbit: Orbit, dt: float) -> Motion:
        """Near the orbit of rigid bodies."""
        return start.from_orbit(_elastic(system), orbit, dt)

    def at_rest(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """All nodes at rest."""
        return start.at_rest(_elastic(system), q, ball, ramped)

    def at_equilibrium(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """All nodes in balance."""
        return start.static_orbit(_elastic(system), q, ball, ramped)

    def has_places(self, balls: str) -> bool:
        """Always: balls are bodies."""
        return True

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,).

        Notes
        -----
        The approach of a contact, that of the ball's centre to the groove where the rigid frame of its ring has it, is
        Hertz's at its load, and the rest: finite bodies, the mesh, and what a penalty lets overlap.
        """
        z, out = model.system.ball_count, {}
        centre = model.system.centre_vectors(equilibrium.displacement)[0]
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            away = centre - equilibrium.ball if race == 0 else equilibrium.ball
            rest = model.geometry.offset_inner if race == 0 else model.geometry.offset_outer
            load = equilibrium.contact_force[race * z : (race + 1) * z]
            out[f"approach_{word}_m"] = np.where(load > 0.0, np.linalg.norm(away, axis=1) - rest, 0.0)
            out[f"approach_hertz_{word}_m"] = np.asarray(ellipse.approach(load))
        return out

    @abstractmethod
    def contact_table(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """What ``report`` says of the contacts; ``mesh`` there is added to what it says of the mesh."""

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json."""
        q, ball, _ = self.rigid.settle(self.guess)
        stiffness = self.rigid.evaluate(q, ball=ball).stiffness
        contacts = self.contact_table(model, equilibrium)
        system: Any = model.system
        y, bodies = system.equilibrium, self.bearing.system
        cage = self.bearing.cage_forces(y)[:, 0]
        across = np.stack([self.bearing.setup.turn(k)[:, 2] for k in range(len(cage))])
        force = bodies.assembly.reactions(y) - cage @ across  # the ideal cage stands on the ground
        load = np.concatenate([model.system.load[:3], model.system.load[3:]])
        energies = bodies.energies(y, np.zeros_like(y)) | {"external": float(bodies.load @ y)}
        scene = model.scene
        mesh = contacts.pop("mesh", {})
        return {
            "rigid_rings": {
                "displacement": dict(zip(COORDINATES, q.tolist(), strict=True)),
                "stiffness": stiffness.tolist(),
            },
            "mesh": {
                "cells": self.bearing.cells,
                "nodes": bodies.assembly.nodes,
                "unknowns": bodies.size,
                "formulation": scene.bodies.formulation,
                "hourglass_coefficient": scene.bodies.hourglass if scene.bodies.formulation == "one_point" else None,
                **mesh,
            },
            "reaction_n": dict(zip("xyz", force.tolist(), strict=True)),
            "unbalanced_n": float(np.abs((force + load[:3]) * model.system.free[:3]).max()),
            "cage_force_n": float(np.abs(cage).max()),
            "energies_j": energies,
            "hourglass_energy_ratio": energies["hourglass"] / max(energies["elastic"], 1e-300),
            **contacts,
            "linear_solver": {
                "iterations": bodies.solver.iterations,
                "solves": bodies.solver.solves,
                "setups": bodies.solver.setups,
            },
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        """Not estimated: a second mesh costs more than the run."""
        return None, Estimate.FINER_MESH()

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Elements that lock."""
        return locking(model.scene)


def _elastic(system: Ring) -> ElasticRing:
    assert isinstance(system, ElasticRing)
    return system
