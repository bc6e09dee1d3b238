"""What a user should know about a recorded motion: balls that unload, ellipses over the edge, motions that cannot be."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.ring.kernels.layout import CENTRIFUGAL
from raceway.core.stepping.record import Record
from raceway.errors import ConvergenceError
from raceway.pipeline.motion import pressures
from raceway.storage.tables import Tables

#: Samples of the last turn that are looked at.
_SAMPLES = 60
#: Part of what a body gives way, by which it lags behind, that is worth a sentence.
_LAG = 0.01
#: Axial force of a row over the centrifugal force of its balls below which Hirano saw gross sliding, and below which it is told.
_ROLLING, _SLIDING = 10.0, 1.0


def refuse_impossible(model: Model, equilibrium: Equilibrium, record: Record) -> None:
    """Refuse a motion that leaves the grooves.

    Raises
    ------
    ConvergenceError
        The ring moves further than the groove centres are apart: the ball would climb out of its groove.
    """
    moved = float(np.abs(record.displacement[:, :3] - equilibrium.displacement[:3]).max())
    limit = model.bearing.largest_motion
    if moved > limit:
        raise ConvergenceError(
            f"the ring moves by {1e3 * moved:.3g} mm, more than the groove centres are apart ({1e3 * limit:.3g} mm): balls "
            f"would leave their grooves. The excitation's force is {model.excitation.amplitude_n:.4g} N: check its unit "
            "(unbalance in kg m), or load the bearing more.",
            {"q": record.final.q, "v": record.final.v, "ball": record.final.ball},
        )


def pressure_warnings(model: Model, force: np.ndarray) -> list[str]:
    """Where the largest contact pressure exceeds that of static load ratings; forces (2 Z,) [N]."""
    limit, rows = model.bearing.static_pressure, model.basis.row
    peaks = pressures(model, force).reshape(2, -1)
    race, ball = np.unravel_index(np.argmax(peaks), (2, len(rows)))
    if not peaks[race][ball] > limit:
        return []
    name = (f"row {rows[ball] + 1}, " if rows[-1] else "") + f"ball {ball - np.argmax(rows == rows[ball])}"
    return [
        f"the contact pressure reaches {1e-6 * peaks[race][ball]:.0f} MPa on the {('inner', 'outer')[race]} race, {name}: above "
        f"{1e-6 * limit:.0f} MPa (static load ratings, ISO 76) ball and race stay dented, which is not computed"
    ]


def motion_warnings(model: Model, record: Record) -> tuple[str, ...]:
    """Sentences about the last turn of a record, each said once."""
    z = model.system.ball_count
    chosen = np.unique(np.linspace(max(len(record.time) - _turn(record), 0), len(record.time) - 1, _SAMPLES).astype(int))
    found = []
    open_balls = int((record.contact_force[chosen, :z] == 0.0).any(axis=0).sum())
    if open_balls:
        found.append(f"{open_balls} of {z} balls lose contact with the inner race during a turn")
    inner, outer = _angles(model, record, chosen)
    force = record.contact_force[chosen]
    over = model.bearing.over_edges(model, inner, outer, force)
    beyond: dict[str, str] = {text: text for text in pressure_warnings(model, force.max(axis=0))}
    for k in np.flatnonzero(over):
        model.bearing.refuse_impossible(model, force[k])
        for text in model.bearing.edge_warnings(model, inner[k], outer[k], force[k]):
            beyond.setdefault(text.split(" reaches ")[0], text)
    b = model.scene.bearing
    if b.radial_clearance is None and b.contact_angle > 0.0 and np.nanmin(inner, initial=np.inf) <= 0.0:
        found.append("the bearing unseats during a turn: the contact angle of a loaded ball is zero or negative")
    return (*found, *(f"during a turn {text}" for text in beyond.values()))


def _angles(model: Model, record: Record, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (n, Z) [rad] of some samples."""
    if model.system.spin is None:
        parts = record.displacement, record.ball, record.contact_force, record.time
        return model.bearing.contact_angles(model, *(part[chosen] for part in parts))
    found = []
    for k in chosen:
        now = attrs.evolve(model, system=model.system.at_speed(record.time[k]))
        found.append(
            model.bearing.contact_angles(
                now, record.displacement[k], record.ball[k], record.contact_force[k], record.time[k]
            )
        )
    inner, outer = zip(*found, strict=True)
    return np.array(inner), np.array(outer)


def _turn(record: Record) -> int:
    return max(record.schedule.steps_per_turn // record.schedule.stride, 1)


def sliding_warnings(model: Model, equilibrium: Equilibrium) -> list[str]:
    """A sentence on thrust-loaded rows whose balls cannot be expected to roll.

    Notes
    -----
    Hirano saw gross sliding of angular-contact bearings under an axial load F_a below 10 Z F_c, F_c the centrifugal force of a
    ball.  Spindles run below that limit with little slip; a tenth of it, F_a < Z F_c, is warned of.  F_a is what the balls press
    on the inner race; rows with a ball that carries nothing there are left out: the criterion is one of thrust loads.

    References
    ----------
    Hirano, Motion of a ball in angular-contact ball bearing, ASLE Transactions 8 (1965) 425-434.
    """
    z, found = model.system.ball_count, []
    load, angle, push = equilibrium.contact_force[:z], equilibrium.angle_inner, model.system.table[:, CENTRIFUGAL]
    for row in range(len(model.scene.bearing.rows)):
        balls = model.basis.row == row
        axial = float((load[balls] * np.abs(np.sin(angle[balls]))).sum()) if (load[balls] > 0.0).all() else np.nan
        if axial < _SLIDING * push[balls].sum():
            ratio = f"{axial / push[balls].sum():.2g} times the centrifugal force of its balls"
            found.append(f"row {row + 1} is pressed together axially with {axial:.4g} N, {ratio}")
    told = (
        f"below {_ROLLING:g} times gross sliding was seen (Hirano 1965). Balls then roll slower than their speeds here say"
    )
    return [f"{', '.join(found)}: {told}. Preload more, or take lighter balls (balls.material)"] if found else []


def inertia_warnings(table: Tables | None, total: float | None) -> list[str]:
    """Where motions that follow at once are off by more than a result's stated error says, and by more than 1 %."""
    found = {} if table is None else table.get("inertia") or {}
    parts = {
        "the inner ring": found.get("inner_supported_error"),
        "the outer ring": found.get("outer_supported_error"),
        "a ball along its grooves": found.get("ball_along_grooves_error"),
    }
    limit = max(_LAG, total or 0.0)
    beyond = {name: share for name, share in parts.items() if share is not None and share > limit}
    if not beyond:
        return []
    worst = max(beyond, key=lambda name: beyond[name])
    return [
        f"{worst} follows at once, which is off by (w / w1)^2 = {beyond[worst]:.2g} of what it gives way: that is not in the stated "
        "error. Elastic bodies (bodies.kind = 'elastic') move with their mass"
    ]
