"""Rows held against Hertz at the same ball load, and against condensed bodies under the same loads and settings."""

from __future__ import annotations

import math

from raceway.storage.tables import ReadTables, Tables

RACES = ("inner", "outer")
#: What the others are held against.
REFERENCE = "condensed"
#: Balls above this part of the largest load count as loaded.
_LOADED = 0.05
#: A displacement below this part of the axial one is none: it has no relative difference.
_NONE = 1e-3


def from_hertz(row: ReadTables) -> Tables:
    """Nodal peak pressures over Hertz's at the same ball load, less 1.

    Returns
    -------
    table : for each race ``ball``, ``load_n`` and ``peak_pressure_pa`` of its most loaded ball with ``most_loaded``, its
        deviation, and ``largest``, the deviation of largest size over all loaded balls; None of rigid bodies, which have no points
    """
    return {race: _pressures(row["balls"], race) for race in RACES}


def _pressures(balls: list[ReadTables], race: str) -> Tables | None:
    nodal, hertz, load = f"peak_pressure_nodal_{race}_pa", f"peak_pressure_{race}_pa", f"load_{race}_n"
    most = max(balls, key=lambda ball: ball[load])
    loaded = [ball for ball in balls if ball[load] > _LOADED * most[load] and ball.get(nodal) is not None]
    if not loaded:
        return None
    off = [ball[nodal] / ball[hertz] - 1.0 for ball in loaded]
    return {
        "ball": balls.index(most),
        "load_n": most[load],
        "peak_pressure_pa": most[nodal],
        "hertz_peak_pressure_pa": most[hertz],
        "most_loaded": off[loaded.index(most)],
        "largest": max(off, key=abs),
        "loaded_balls": len(loaded),
    }


def below_contact(row: ReadTables) -> list[Tables]:
    """Largest shear stress and its depth in ball and ring below the most loaded contact of each race, over Hertz's, less 1."""
    return [
        {
            **one,
            "shear_deviation": _over(one["largest_shear_pa"], one["hertz_largest_shear_pa"]),
            "depth_deviation": _over(one["depth_m"], one["hertz_depth_m"]),
        }
        for one in row["subsurface"]
    ]


def at_rest(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of two rows at rest: x, y, kyy, and the largest of a ball's load over the largest load.

    y is None where the load is axial.
    """
    here, there = row["displacement"], reference["displacement"]
    sideways = abs(there["y"]) > _NONE * abs(there["x"])
    return {
        "ball_loads": max(_loads(row["balls"], reference["balls"], f"load_{race}_n") for race in RACES),
        "x": _over(here["x"], there["x"]),
        "y": _over(here["y"], there["y"]) if sideways else None,
        "kyy": _over(row["kyy_n_per_m"], reference["kyy_n_per_m"]),
    }


def in_motion(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of K, C and |Z| of two motions; ``wc``: that of w C over the reference's |Z|, where C is next to nothing."""
    here, there = identified(row), identified(reference)
    speed = reference["identification"]["speed_rpm"] * math.pi / 30.0
    off: Tables = {name: _over(here[name], there[name]) for name in here}
    return off | {"wc": speed * (here["c"] - there["c"]) / there["abs_z"]}


def identified(row: ReadTables) -> dict[str, float]:
    """K [N/m], C [N s/m] and |Z| [N/m] of a motion."""
    found = row["identification"]
    return {
        "k": found["equivalent_stiffness"],
        "c": found["equivalent_damping"],
        "abs_z": found["dynamic_stiffness"]["abs"],
    }


def _loads(balls: list[ReadTables], others: list[ReadTables], load: str) -> float:
    return max(abs(a[load] - b[load]) for a, b in zip(balls, others, strict=True)) / max(b[load] for b in others)


def _over(value: float, reference: float) -> float | None:
    return value / reference - 1.0 if reference else None
