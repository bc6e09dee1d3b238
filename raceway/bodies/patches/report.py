"""What a result tells of contacts at surface points: pressures, adequacy of the points, what elasticity changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.condensed.inertia import inertia_table
from raceway.bodies.contact_error import overlap
from raceway.bodies.elastic.locking import locking
from raceway.bodies.model import Bearing, Told
from raceway.core.patches.patch import Spacing
from raceway.core.patches.pressure import ContactState, PressureField, pressure_field
from raceway.core.patches.system import PatchSystem, Pool
from raceway.core.record import Record
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.ring import COORDINATES, Evaluation, Ring
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.estimate import Estimate
from raceway.scene.inner_ring import load_at_edge
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model

#: Entries of the stiffness below this part of sqrt(K_ii K_jj) are ripple or cancel out: no relative difference.
_NOTHING = 0.02
#: Points along a semi-axis below which the largest pressure is off by more than 1 %.
_ENOUGH = 3.0


@attrs.frozen(eq=False)
class NodalBearing(Bearing):
    """Condensed rings and balls with pressures at surface points.

    Attributes
    ----------
    nodes : points along each semi-axis of the inner contact at ``load`` [N]
    spacing : Spacing
    pool : patches as they are now
    rigid : the same scene with rigid bodies;  beside : (5,) where its equilibrium is looked for
    coarser : builds the same system with half as many points; None where there are no fewer
    """

    nodes: float
    load: float
    spacing: Spacing
    pool: Pool
    rigid: System
    beside: np.ndarray
    coarser: Callable[[], Ring] | None
    _errors: dict[bytes, tuple[float | None, str]] = attrs.field(init=False, factory=dict)

    def friction_lost(self, system: Ring, record: Record) -> float:
        """By the points' memory."""
        assert isinstance(system, PatchSystem)
        return system.friction_lost(record)

    def settle(
        self, near: np.ndarray | None = None, on_progress: Callable[[str, int, int], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """From a near equilibrium, what is held staying where it is; from the own guess where that fails."""
        if near is not None:
            try:
                return self.system.settle(np.where(self.system.free > 0.0, near, self.guess))
            except ConvergenceError:
                pass  # the own guess decides whether there is an equilibrium
        return super().settle()

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """The overlap that a law leaves."""
        return overlap(self.ball_columns(model, equilibrium), equilibrium)

    def pressed(self, model: Model, equilibrium: Equilibrium) -> tuple[Evaluation, list[ContactState]]:
        """The state and the contacts' answers at the equilibrium, inner races first."""
        system: Any = model.system.without(CAGE)
        now = system.evaluate(equilibrium.displacement, ball=equilibrium.ball)
        return now, system.pressures()

    def pressure_field(self, model: Model, equilibrium: Equilibrium, ball: int, inner: bool = True) -> PressureField:
        """Pressures of one contact at the equilibrium."""
        contacts = self.pressed(model, equilibrium)[1]
        which = ball if inner else ball + model.system.ball_count
        return pressure_field(self.pool.patches[0 if inner else 1], contacts[which])

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,).

        Notes
        -----
        The approach of a contact is Hertz's at its load, what a law's penetration adds, and the rest, which finite rings
        and balls give less or more than half-spaces.
        """
        now, contacts = self.pressed(model, equilibrium)
        z, out = model.system.ball_count, {}
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            chosen = contacts[race * z : (race + 1) * z]
            load = now.contact_force[race * z : (race + 1) * z]
            approach = np.where(load > 0.0, -now.gap[race * z : (race + 1) * z], 0.0)
            left = np.array([one.penetration for one in chosen])
            area = self.pool.patches[race].area
            out[f"peak_pressure_nodal_{word}_pa"] = np.array([one.load.max(initial=0.0) / area for one in chosen])
            out[f"points_{word}"] = np.array([float(len(one.nodes)) for one in chosen])
            across = np.array([float(ellipse.semi_axes(f)[1]) for f in load]) / self.spacing.across
            along = np.array([float(ellipse.semi_axes(f)[0]) for f in load]) / self.spacing.along
            out[f"points_per_semi_axis_{word}"] = np.minimum(across, along)
            out[f"approach_{word}_m"] = approach
            out[f"approach_hertz_{word}_m"] = np.asarray(ellipse.approach(load))
            out[f"approach_penetration_{word}_m"] = left
            out[f"approach_structural_{word}_m"] = approach - np.asarray(ellipse.approach(load)) - left
        return out

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json."""
        q, ball, _ = self.rigid.settle(self.beside)
        now = self.rigid.evaluate(q, ball=ball)
        stiffness, _ = self.rigid.rows_following(q, now, now.stiffness, now.damping)
        columns = self.ball_columns(model, equilibrium)
        error, how = self._change_from_coarser(model, equilibrium)
        counts = [columns[f"points_per_semi_axis_{word}"] for word in ("inner", "outer")]
        loaded = equilibrium.contact_force[: model.system.ball_count] > 0.0
        approach = columns["approach_inner_m"][loaded]
        share = columns["approach_penetration_inner_m"][loaded] / approach if loaded.any() else np.zeros(1)
        scale = np.sqrt(np.abs(np.outer(np.diag(stiffness), np.diag(stiffness))))
        told = np.abs(stiffness) > _NOTHING * scale
        return {
            "bodies": "condensed: finite elements of rings and balls, pressures at surface points",
            "rigid_rings": {
                "displacement": dict(zip(COORDINATES, q.tolist(), strict=True)),
                "stiffness": stiffness.tolist(),
            },
            "elasticity": [
                [float(equilibrium.stiffness[i, j] / stiffness[i, j] - 1.0) if told[i, j] else None for j in range(5)]
                for i in range(5)
            ],
            "mesh": {
                "nodes_per_semi_axis": self.nodes,
                "at_ball_load_n": self.load,
                "least_nodes_per_semi_axis": float(min(np.min(c[loaded], initial=np.inf) for c in counts)),
                "spacing_along_m": self.spacing.along,
                "spacing_across_m": self.spacing.across,
                "change_from_coarser": error,
                "how": how,
            },
            "inertia": inertia_table(model, equilibrium),
            "penetration_share": float(share.max(initial=0.0)),
            "tangent": "mean over all places of the points under the ellipses, which takes away its ripple",
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        """Relative error by too few points: of the displacement or, where a motion is identified, by the ripple if larger.

        Notes
        -----
        The displacement's is of order 2: a third of what half as many points change.  The ripple is measured at one place
        of the points, against the mean over all places; a motion of some micrometres meets a few places and averages some of it.
        """
        error, how = self._change_from_coarser(model, equilibrium)
        if model.scene.excitation is None or not {"record", "speeds"} & set(model.scene.identifier.method.needs):
            return error, how
        ripple = self._ripple(model, equilibrium)
        if error is not None and error >= ripple:
            return error, Estimate.FEWER_POINTS_NOT_RIPPLE(ripple=ripple)
        return ripple, Estimate.RIPPLE(change="" if error is None else f"; {how} is {error:.2g}")

    def _ripple(self, model: Model, equilibrium: Equilibrium) -> float:
        """Largest relative difference of a radial tangent at the equilibrium from the mean over all places of the points."""
        now, _ = self.pressed(model, equilibrium)
        return float(np.abs(np.diag(now.stiffness)[1:3] / np.diag(equilibrium.stiffness_rows_held)[1:3] - 1.0).max())

    def _change_from_coarser(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        if self.coarser is None:
            return None, Estimate.FEWEST_POINTS()
        state = model.system.load.tobytes() + equilibrium.displacement.tobytes()
        if state not in self._errors:
            self._errors[state] = self._compared(self.coarser, model, equilibrium)
        return self._errors[state]

    @staticmethod
    def _compared(coarser: Callable[[], Ring], model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        try:
            coarse = coarser()
            q, _, _ = attrs.evolve(coarse, load=model.system.load).settle(equilibrium.displacement)
        except RacewayError as why:
            return None, Estimate.FEWER_POINTS_FAILED(why=why)
        weight = np.array([1.0, 1.0, 1.0, model.system.arm, model.system.arm])
        change = np.abs((q - equilibrium.displacement) * weight).max() / np.abs(equilibrium.displacement * weight).max()
        return float(change) / 3.0, Estimate.FEWER_POINTS()

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Contacts that the groove's edge cuts off, with the load at which that begins; points that are too few; elements that lock."""
        _, contacts = self.pressed(model, equilibrium)
        z, radius, found = model.system.ball_count, 0.5 * model.geometry.ball_diameter, locking(model.scene)
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            cut = [one for one in contacts[race * z : (race + 1) * z] if one.truncated]
            if not cut:
                continue
            sense = self.pool.patches[race].race.sense
            worst = max(cut, key=lambda one: float(np.hypot(*one.force)))
            angle = float(np.arctan2(-sense * worst.force[0], -sense * worst.force[1]))
            low, high = self.pool.patches[race].race.edges
            edge, angle = (high, angle) if high - angle < angle - low else (-low, -angle)
            begins = load_at_edge(ellipse, radius, edge - angle)
            found.append(
                f"{len(cut)} contact(s) on the {word} race are cut off by the groove's edge at {np.degrees(edge):.1f} deg: at "
                f"{np.degrees(angle):.1f} deg that begins at {begins:.3g} N a ball; the pressure at the edge depends on the mesh"
            )
        columns = self.ball_columns(model, equilibrium)
        loaded = equilibrium.contact_force[:z] > 0.05 * equilibrium.contact_force[:z].max(initial=1e-300)
        least = float(columns["points_per_semi_axis_inner"][loaded].min(initial=np.inf))
        if least < _ENOUGH:
            found.insert(
                0,
                f"only {least:.1f} points lie along a semi-axis of a loaded contact: take more mesh.nodes_per_semi_axis for its "
                "pressure, which is off by percents below 3",
            )
        return found
