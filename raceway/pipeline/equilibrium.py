"""The static state under the constant loads, ball by ball: equilibrium and pressures."""

from collections.abc import Callable
from math import degrees
from typing import cast

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, tilts_follow
from raceway.bodies.mounting import held_table, lost_preload, preload_table
from raceway.core.record import Record
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.ring import COORDINATES
from raceway.errors import ConvergenceError
from raceway.framework.contracts import LawReport
from raceway.framework.duties import law_report, renews
from raceway.pipeline.content import AtRest
from raceway.storage.tables import Tables

#: Share of its free contact angle at which a row without a clearance counts as unseated.
_SEATED = 0.5


def solve_equilibrium(
    model: Model, on_progress: Callable[[str, int, int], None] | None = None, near: np.ndarray | None = None
) -> Equilibrium:
    """The static equilibrium of a model; ``ConvergenceError`` for none, or a motion that nothing holds (named).

    near : (5,) equilibrium of a similar model, which contacts at surface points start from; others take microseconds
    on_progress : called as ``on_progress(what, done, total)`` while elastic bodies are solved; ``total`` is 0: nobody knows
    """
    system = model.system
    has_load = np.any(model.system.load * model.system.free) or model.problem.bearing.preloaded
    if not has_load and model.system.free[0] > 0.0:
        raise ConvergenceError(
            "no load acts on the bearing: all motions are free and the stiffness is undefined. Set `load.axial`, or hold "
            'the ring with supports.axial = "displacement" under an axial load.'
        )
    # What nothing holds shows on another system in milliseconds, where the bearing's own equilibrium takes minutes.
    if (rigid := model.bearing.foreseen) is not None:
        q, ball, _ = rigid.solve_equilibrium(model.bearing.guess)
        _refuse_free_motion(model, rigid.stiffness_at(q, rigid.evaluate(q, ball=ball)), q)
    q, ball, iterations = model.bearing.solve_equilibrium(near, on_progress)
    still = system.without(CAGE)
    now = still.evaluate(q, ball=ball)
    rates = still.stiffness_at(q, now), still.damping_at(q, now)
    stiffness, damping = still.rows_following(q, now, *rates)
    _refuse_free_motion(model, stiffness, q)
    inner, outer = model.bearing.contact_angles(model, q, now.ball, now.contact_force)
    model.bearing.refuse_impossible(model, now.contact_force, {"q": q, "ball": now.ball})
    warnings = _warnings(model, inner, outer, now.contact_force)
    state = now.ball, now.gap, now.contact_force, inner, outer
    equilibrium = Equilibrium(q, stiffness, damping, *rates, *state, iterations, warnings)
    law = law_report_of(model, equilibrium)
    return equilibrium if law is None else attrs.evolve(equilibrium, warnings=(*law.warnings, *warnings))


def _refuse_free_motion(model: Model, stiffness: np.ndarray, q: np.ndarray) -> None:
    system = model.system
    free, scale = np.flatnonzero(system.free), 1.0 / system.arm
    weight = np.array([1.0, 1.0, 1.0, scale, scale])[free]
    matrix = weight[:, None] * (stiffness + system.stiffness)[free[:, None], free] * weight
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    loose = values <= 1e-12 * max(values[-1], 0.0)
    if not loose.any():
        return
    # Of several free motions any combination is one: the parts of all of them, equal ones in the order of coordinates.
    motion = np.round(np.linalg.norm(vectors[:, loose], axis=1), 3)
    names = [COORDINATES[free[k]] for k in np.argsort(-motion, kind="stable") if motion[k] > 0.3 * motion.max()]
    remedy = "supports.tilt" if names[0].startswith("tilt") else "an axial load"
    why = lost_preload(model) or f"Hold it ({remedy}) or load more balls."
    raise ConvergenceError(f"the equilibrium is singular: no stiffness against {' with '.join(names)}. {why}", {"q": q})


def _warnings(model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[str, ...]:
    # Rows that lift off, and rows with a loaded ball at half its free contact angle or less; those with a clearance run at any.
    problem, bearing, warnings = model.problem, model.problem.bearing, list[str]()
    for k, row in enumerate(bearing.of_rows):
        name = f"row {k + 1}" if len(bearing.rows) > 1 else "the bearing"
        least, free = np.fmin.reduce(inner, where=model.basis.row == k, initial=np.inf), model.problem.running.free_angle(k)
        if least == np.inf:
            warnings.append(f"{name} lifts off: none of its balls touches the inner race")
        elif row.contact_angle > 0.0 and row.radial_clearance is None and least <= _SEATED * free:
            angles = f"{np.degrees(least):.2f} deg, {np.degrees(free):.3g} deg without loads"
            words = f"{name} loses axial contact: the contact angle of a loaded ball is {angles}. The axial load is too small or has the wrong sign"
            warnings.append(words)
    if any(problem.load.moment) and not problem.tilts:
        warnings.append("`load.moment` has no effect: supports.tilt is locked")
    if problem.contact.friction > 0.0 and model.traits.every_node:
        words = "equilibria and static stiffness of elastic bodies are frictionless: contact.friction acts in motions only"
        warnings.append(words)
    elif problem.contact.friction > 0.0:
        warnings.append("friction is on: balls that do not roll add a tangential stiffness, which rotating bearings lack")
    return (*warnings, *model.bearing.edge_warnings(model, inner, outer, force))


def equilibrium_table(model: Model, equilibrium: Equilibrium) -> AtRest:
    """The table ``equilibrium`` of result.json."""
    z = model.system.ball_count
    load_inner, load_outer = equilibrium.contact_force[:z], equilibrium.contact_force[z:]
    columns = {
        "azimuth_deg": np.degrees(model.azimuth) % 360.0,
        "load_inner_n": load_inner,
        "load_outer_n": load_outer,
        "contact_angle_inner_deg": np.degrees(equilibrium.angle_inner),
        "contact_angle_outer_deg": np.degrees(equilibrium.angle_outer),
    }
    for race, (word, load) in enumerate((("inner", load_inner), ("outer", load_outer))):
        pressure, a, b = model.bearing.contact_ellipse(model, race, load)
        columns[f"peak_pressure_{word}_pa"] = pressure
        columns[f"semi_major_{word}_m"] = a
        columns[f"semi_minor_{word}_m"] = b
    columns |= model.bearing.ball_columns(model, equilibrium)
    law = law_report_of(model, equilibrium)
    for name, values in {} if law is None else law.columns.items():
        columns |= {f"inner_{name}": values[:z], f"outer_{name}": values[z:]}
    several = len(model.problem.bearing.rows) > 1
    rows: list[dict[str, int]] = [{"row": int(row) + 1} if several else {} for row in model.basis.row]
    peaks = np.concatenate([columns["peak_pressure_inner_pa"], columns["peak_pressure_outer_pa"]])
    table = {
        "displacement": dict(zip(COORDINATES, equilibrium.displacement.tolist(), strict=True)),
        "stiffness": equilibrium.stiffness.tolist(),
        "damping": equilibrium.damping.tolist(),
        "stiffness_rows_held": None if model.system.sliding is None else equilibrium.stiffness_rows_held.tolist(),
        "damping_rows_held": None if model.system.sliding is None else equilibrium.damping_rows_held.tolist(),
        "kyy_tilts_follow_n_per_m": tilts_follow(equilibrium.stiffness, model.problem.supports.tilt),
        "free_contact_angle_deg": degrees(model.geometry.contact_angle),
        **largest_contacts(equilibrium.contact_force, peaks, "largest"),
        "balls": [{**rows[k], **{key: column[k].item() for key, column in columns.items()}} for k in range(z)],
        "law": None if law is None else dict(law.table),
        "preload": preload_table(model, equilibrium),
        "held_axial": held_table(model, equilibrium),
        "iterations": equilibrium.iterations,
    }
    return cast(AtRest, table)


def motion_table(model: Model, record: Record) -> Tables:
    """The table ``motion`` of result.json: mean axial displacement, and the largest of each race in the evaluated turns.

    record : its columns of ``contact_force`` (n, 2 Z) are the inner races, then the outer ones [N]
    """
    peaks = np.array([peak(column[:, None]) for column in record.contact_force.T])
    axial = float(record.displacement[:, 0].mean())
    return {"axial_displacement_m": axial, **largest_contacts(peaks, pressures(model, peaks), "peak")}


def pressures(model: Model, loads: np.ndarray) -> np.ndarray:
    """(2 Z,) peak pressures [Pa] at loads (2 Z,) [N] of the inner races, then of the outer ones."""
    return np.concatenate([model.bearing.contact_ellipse(model, k, half)[0] for k, half in enumerate(np.split(loads, 2))])


def largest_contacts(loads: np.ndarray, pressures: np.ndarray, word: str) -> Tables:
    """Of loads and pressures (2 Z,) [N, Pa] the largest of both races, its race, and each race's; ``word`` begins the names."""
    table: Tables = {}
    for name, unit, values in (("ball_load", "n", loads), ("pressure", "pa", pressures)):
        ends = values.reshape(2, -1).max(axis=1).tolist()
        table |= {f"{word}_{name}_{unit}": max(ends), f"{word}_{name}_race": race_of(*ends)}
        table |= {f"{word}_{name}_{race}_{unit}": end for race, end in zip(("inner", "outer"), ends, strict=True)}
    return table


def race_of(inner: float, outer: float) -> str:
    """The race of the larger number: "inner", "outer", or "both" where they are equal but for rounding."""
    return "both" if np.isclose(inner, outer, rtol=1e-9, atol=0.0) else "inner" if inner > outer else "outer"


def peak(samples: np.ndarray) -> float:
    """Largest value of curves sampled at equidistant times, (n, k), by a parabola through the largest sample's neighbours."""
    row, column = np.unravel_index(int(np.argmax(samples)), samples.shape)
    top = float(samples[row, column])
    if not 0 < row < len(samples) - 1:
        return top
    before, after = float(samples[row - 1, column]), float(samples[row + 1, column])
    bend = before - 2.0 * top + after
    return top if bend >= 0.0 else top - (before - after) ** 2 / (8.0 * bend)


def law_report_of(model: Model, equilibrium: Equilibrium) -> LawReport | None:
    """What the scene's law reports of its contacts in an equilibrium; None where it reports nothing."""
    if not renews(model.problem.contact.law):
        return None
    from raceway.bodies.running import running_pairs

    angles = (equilibrium.angle_inner, equilibrium.angle_outer)
    pairs = running_pairs(model.problem, model.basis, equilibrium.contact_force, angles)
    return law_report(model.problem.contact.law, pairs)
