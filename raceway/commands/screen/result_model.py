"""What ``raceway run`` shows of elastic bodies: the table ``model`` of result.json."""

from __future__ import annotations

from collections.abc import Sequence

from raceway.commands.screen.text import Row, number
from raceway.storage.tables import ReadTables

#: Counts of elements at a contact, and where they are counted: four of each resolve its stresses.
_CELLS = {
    "cells_to_hertz_depth": "down to Hertz's depth",
    "cells_per_semi_major": "along the ellipse's major semi-axis",
    "cells_per_semi_minor": "along the ellipse's minor semi-axis",
}


def bodies_rows(model: ReadTables | None) -> list[Row]:
    """Effect of elasticity, quality of the mesh, and error of the missing inertia; each where the result has it."""
    if not model:
        return []
    rows = [("Elastic bodies", "", str(model.get("bodies", "")))]
    elasticity = model.get("elasticity")
    if elasticity is not None:
        told = ", ".join("-" if elasticity[i][i] is None else f"{100 * elasticity[i][i]:+.1f} %" for i in (0, 1))
        rows.append(("kxx, kyy changed by", told, "against rigid rings and balls under the same loads"))
    taken = model.get("compliance")
    if taken is not None:
        values = ", ".join(f"{1e9 * taken[name]:.2f}" for name in ("inner_m_per_n", "outer_m_per_n"))
        angle = f"inner, outer contact at {taken['contact_angle_deg']:.1f} deg, beyond Hertz"
        rows.append(("structural compliance", f"{values} nm/N", angle))
    mesh = model.get("mesh") or {}
    along, change = mesh.get("nodes_per_semi_axis"), mesh.get("change_from_coarser")
    if along is not None:
        how = "not estimated" if change is None else f"{mesh['how']}: {change:.1e}"
        rows.append(("nodes per semi-axis", number(along, digits=3), how))
    sure = mesh.get("replaced_uncertainty")
    if sure is not None:
        values = ", ".join(f"{1e9 * mesh[f'replaced_{race}_m_per_n']:.2f}" for race in ("inner", "outer"))
        how = f"inner, outer: what the mesh gives way under a contact; known to {100.0 * sure:.1g} % of the contact's compliance"
        rows.append(("replaced by the law", f"{values} nm/N", how))
    share, unbalanced, energies = (model.get(name) for name in ("penetration_share", "unbalanced_n", "energies_j"))
    if share is not None:
        rows.append(
            ("penetration share", number(100.0 * share, "%", 3), "of the approach, at most: what the law lets overlap")
        )
    rows += _subsurface(model.get("subsurface") or [])
    if unbalanced is not None:
        rows.append(("unbalanced force", number(unbalanced, "N", 2), "largest, reaction against load"))
    if energies is not None:
        shown = ", ".join(f"{name} {1e3 * value:.3g}" for name, value in energies.items())
        rows.append(("energies", "", f"{shown} mJ"))
    inertia = model.get("inertia")
    if inertia is not None:
        rows += _inertia(inertia)
    return rows


def _subsurface(sides: Sequence[ReadTables]) -> list[Row]:
    """The largest shear stress below the most loaded contact of each race, a row each; no number that the mesh does not resolve."""
    rows: list[Row] = []
    for race in dict.fromkeys(str(side["race"]) for side in sides):
        pair = [side for side in sides if side["race"] == race]
        fine, coarse = ([side for side in pair if bool(side["resolved"]) is wanted] for wanted in (True, False))
        value = ", ".join(f"{1e-6 * side['largest_shear_pa']:.0f}" for side in fine)
        told = []
        if fine:
            bodies, depths = (
                ", ".join(side["body"] for side in fine),
                ", ".join(f"{1e6 * side['depth_m']:.0f}" for side in fine),
            )
            told.append(f"{bodies}, {depths} µm deep")
        if coarse:
            worst, key = min(((side, key) for side in coarse for key in _CELLS), key=lambda pair: pair[0][pair[1]])
            bodies = " and ".join(side["body"] for side in coarse)
            which = "not resolved" if fine else "by this mesh"
            told.append(f"{which} in {bodies}: {worst[key]:.2g} elements {_CELLS[key]}, not 4")
        told.append(f"Hertz {1e-6 * pair[0]['hertz_largest_shear_pa']:.0f} MPa at {1e6 * pair[0]['hertz_depth_m']:.0f} µm")
        rows.append((f"largest shear, {race}", f"{value} MPa" if fine else "not resolved", "; ".join(told)))
    return rows


def _inertia(inertia: ReadTables) -> list[Row]:
    """The slowest motion that is taken to follow at once."""
    names = {
        "inner_supported": "inner ring",
        "outer_supported": "outer ring",
        "ball_along_grooves": "ball along its grooves",
    }
    known = {word: name for name, word in names.items() if inertia.get(f"{name}_hz") is not None}
    if not known:
        return []
    slowest = min(known, key=lambda word: inertia[f"{known[word]}_hz"])
    error = inertia[f"{known[slowest]}_error"]
    moves = " is part of the motion" if slowest.startswith("ball") and inertia.get("ball_along_grooves_in_motion") else ""
    costs = moves if error is None else f" follows at once, which is off by (w / w1)^2 = {error:.1e}"
    rings = min(inertia[f"{known[word]}_hz"] for word in known if word != "ball along its grooves")
    remark = f"{slowest}{costs}; rings as supported from {1e-3 * rings:.3g} kHz"
    return [("slowest own motion", number(1e-3 * inertia[f"{known[slowest]}_hz"], "kHz", 3), remark)]
