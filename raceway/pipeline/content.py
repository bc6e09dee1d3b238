"""result.json by its keys: what ``Result.to_dict`` writes, and screens, pages and studies read; None where a number does not exist.

Tables of plug-ins (bodies, quantities, laws) have the keys that these give them.
"""

from typing import NotRequired, TypedDict

from raceway.storage.tables import Tables


class AtRest(TypedDict):
    """``equilibrium``: displacement [m, rad] by coordinates, (5, 5) stiffness and damping; of each ball loads, angles and pressures."""

    displacement: dict[str, float]
    stiffness: list[list[float]]
    damping: list[list[float]]
    stiffness_rows_held: list[list[float]] | None
    damping_rows_held: list[list[float]] | None
    kyy_tilts_follow_n_per_m: float | None
    free_contact_angle_deg: float
    largest_ball_load_race: str
    balls: list[Tables]
    law: Tables | None
    preload: Tables | None
    held_axial: dict[str, float] | None
    iterations: int


class ErrorTable(TypedDict):
    """``error``: sizes relative to |Z|, None where not estimated; ``how`` and ``short`` have the same names."""

    total: float | None
    time_step: float | None
    transient: float | None
    mesh: float | None
    contact: float | None
    identification: float | None
    bodies: float | None
    how: dict[str, str]
    unresolved: list[str]
    model: NotRequired[Tables | None]
    short: NotRequired[dict[str, str]]


class Content(TypedDict):
    """All tables of the file, beside one for each plug-in of quantities."""

    schema: int
    title: str
    scene: Tables
    plan: Tables
    geometry: Tables | None
    equilibrium: AtRest
    not_computed: dict[str, str]
    identification: Tables | None
    model: Tables | None
    motion: Tables | None
    uncertainty: Tables
    tolerances: Tables | None
    error: ErrorTable
    cost: dict[str, float]
    stability: Tables
    environment: Tables
    warnings: list[str]
