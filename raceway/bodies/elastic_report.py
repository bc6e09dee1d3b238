"""What a result tells of elastic bodies: pressures, approaches, reactions, energies, mesh, and the balance of forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.locking import locking
from raceway.core.elastic.bearing import ElasticBearing
from raceway.core.elastic.recovery import deepest_penetration, peak_at_nodes, peak_at_points, points_in_contact
from raceway.core.system import COORDINATES, System

if TYPE_CHECKING:
    from raceway.model import Model
    from raceway.statics import Equilibrium

#: Points in a loaded contact below which its pressure is off by tens of percent.
_FEW_POINTS = 60


@attrs.frozen(eq=False)
class ElasticBodies:
    """Elastic bodies beyond their system.

    Attributes
    ----------
    bearing : ElasticBearing
    rigid : the same scene with rigid bodies and Hertz's contacts;  guess : (5,) where its equilibrium is looked for
    """

    bearing: ElasticBearing
    rigid: System
    guess: np.ndarray

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,).

        Notes
        -----
        The approach of a contact, that of the ball's centre to the groove where the rigid frame of its ring has it, is
        Hertz's at its load, what the penalty lets overlap, and the rest: finite bodies and the mesh.
        """
        system: Any = model.system
        system.in_place(system.equilibrium)
        contact: Any = self.bearing.system.contact
        z, out = model.system.ball_count, {}
        centre = model.system.centre_vectors(equilibrium.displacement)[0]
        found = {
            "peak_pressure_points": peak_at_points(contact),
            "peak_pressure_nodal": peak_at_nodes(contact),
            "points": points_in_contact(contact).astype(float),
            "approach_penetration": deepest_penetration(contact),
        }
        units = {"peak_pressure_points": "_pa", "peak_pressure_nodal": "_pa", "points": "", "approach_penetration": "_m"}
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            part = slice(race * z, (race + 1) * z)
            away = centre - equilibrium.ball if race == 0 else equilibrium.ball
            rest = model.geometry.offset_inner if race == 0 else model.geometry.offset_outer
            load = equilibrium.contact_force[part]
            for name, values in found.items():
                out[f"{name}_{word}{units[name]}"] = values[part]
            out[f"approach_{word}_m"] = np.where(load > 0.0, np.linalg.norm(away, axis=1) - rest, 0.0)
            out[f"approach_hertz_{word}_m"] = np.asarray(ellipse.approach(load))
        return out

    def report(self, model: Model, equilibrium: Equilibrium) -> dict[str, Any]:
        """The table ``model`` of result.json."""
        q, ball, _ = self.rigid.settle(self.guess)
        stiffness = self.rigid.evaluate(q, ball=ball).stiffness
        columns = self.ball_columns(model, equilibrium)
        loaded = equilibrium.contact_force > 0.0
        approach, left = (
            np.concatenate([columns[f"{name}_{word}_m"] for word in ("inner", "outer")])[loaded]
            for name in ("approach", "approach_penetration")
        )
        share = left / np.maximum(approach, 1e-300) if loaded.any() else np.zeros(1)
        system: Any = model.system
        y, bodies = system.equilibrium, self.bearing.system
        force = bodies.assembly.reactions(y)
        load = np.concatenate([model.system.load[:3], model.system.load[3:]])
        energies = bodies.energies(y, np.zeros_like(y)) | {"external": float(bodies.load @ y)}
        pushed = np.abs(self.bearing.cage_forces(y)[:, 0]).max()
        scene = model.scene
        return {
            "bodies": "elastic: every node of rings and balls, pressures at surface points",
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
            },
            "reaction_n": dict(zip("xyz", force.tolist(), strict=True)),
            "unbalanced_n": float(np.abs((force + load[:3]) * model.system.free[:3]).max()),
            "cage_force_n": float(pushed),
            "energies_j": energies,
            "hourglass_energy_ratio": energies["hourglass"] / max(energies["elastic"], 1e-300),
            "max_penetration_m": float(left.max(initial=0.0)),
            "penetration_share": float(share.max()),
            "linear_solver": {
                "iterations": bodies.solver.iterations,
                "solves": bodies.solver.solves,
                "setups": bodies.solver.setups,
            },
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        """Not estimated: a second mesh costs more than the run."""
        return None, "not estimated: run the scene with a finer mesh, or with bodies.kind = 'condensed'"

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Contacts with too few points for their pressure; elements that lock."""
        found = locking(model.scene)
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
        return found
