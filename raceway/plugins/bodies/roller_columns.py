"""Cylindrical rollers at n operating points at once."""

from __future__ import annotations

import numpy as np

from raceway.bodies.columns import ColumnBearing, assembled_columns
from raceway.core.ring.equilibria import States
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.plugins.bodies.roller_bearing import Rollers, first_roller_guess, line_contact, roller_basis, roller_parts
from raceway.scene.bearing import DIMENSIONS


class RollerColumns(ColumnBearing):
    """The ring on its rollers at n points."""

    @property
    def conspicuous(self) -> np.ndarray:
        """(n,) whether numbers leave no bearing, or nothing loads it."""
        load, wrong = self.problem.load, np.zeros(self.problem.points, dtype=bool)
        for rule in DIMENSIONS:
            wrong |= rule.when(self.problem.bearing)
        return wrong | ~(np.hypot(*load.radial) + np.hypot(*load.moment) > 0.0)

    def contact_angles(self, states: States) -> tuple[np.ndarray, np.ndarray]:
        """Zero where a contact is loaded; nan where it is open."""
        inner, outer = np.split(np.where(states.force > 0.0, 0.0, np.nan), 2, axis=1)
        return inner, outer

    def contact_ellipse(self, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of line contacts, under loads (n, 2, Z) [N]."""
        kind: Rollers = self.problem.bodies
        basis, radii = roller_basis(self.problem)
        radius = np.stack([np.reshape(r, (-1, 1)) for r in radii], axis=1)
        return line_contact(load, radius, kind.roller_length, np.reshape(basis.modulus, (-1, 1, 1)))

    def pressures(self, force: np.ndarray) -> np.ndarray:
        """(n, 2 Z) peak pressures [Pa] under contact forces (n, 2 Z) [N]."""
        return self.contact_ellipse(force.reshape(len(force), 2, -1))[0].reshape(force.shape)

    def impossible(self, force: np.ndarray) -> np.ndarray:
        """(n,) whether any contact would be as wide as half a roller."""
        half = self.contact_ellipse(force.reshape(len(force), 2, -1))[2]
        return np.asarray(2.0 * half.max(axis=(1, 2)) >= 0.5 * self.basis.geometry.ball_diameter)


def roller_columns(problem: Problem, plan: ScenePlan) -> RollerColumns:
    """See ``raceway.bodies.columns.Builder``."""
    basis, radii = roller_basis(problem)
    kind: Rollers = problem.bodies
    bearing = assembled_columns(RollerColumns, problem, plan, basis, roller_parts(problem, plan, basis, radii, kind))
    bearing.points.guess[:] = first_roller_guess(problem)
    return bearing
