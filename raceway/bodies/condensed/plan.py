"""Plan of condensed rings with contact resultants: cost and limits of their sections; nothing is meshed."""

from __future__ import annotations

from math import ceil, log, pi

import attrs

from raceway.errors import Mistake
from raceway.scene.scene import Scene

#: The part by which balls feel each other.
BETWEEN_BALLS = "effect of balls on each other through the rings"
#: Bytes and seconds of processor time for both rings, by nodes of a section, measured on one core of a small server: the
#: factor of a harmonic, and some seventy of those; balls and a coarser mesh for the error included.
_BYTES_PER_NODE = 25_000
_BASE_S, _SECONDS, _NODES, _POWER = 0.4, 4.8, 4000.0, 1.3
_BYTES_LIMIT = 2 * 2**30
#: A seat that gives way by more than this part of a ball's diameter under the scene's loads holds no bearing.
_GIVES = 0.02


@attrs.frozen
class SectionCost:
    """Predictions: ``nodes`` of the larger section, ``bytes`` at the peak, ``seconds`` of processor time, nothing kept."""

    nodes: int
    bytes: int
    seconds: float


def section_cost(scene: Scene) -> SectionCost:
    """Predicted cost of the rings of a condensed scene."""
    b = scene.bearing
    length = 0.34 * b.ball_diameter
    size, along = 0.62 * length, 0.077 * length
    if scene.mesh is not None:
        size = min(float(getattr(scene.mesh, "element_size", size)), size)
        # A contact's semi-major axis is about a tenth of the ball; see raceway.bodies.condensed.build.
        along = min(0.09 * b.ball_diameter / float(getattr(scene.mesh, "nodes_per_semi_axis", 4)), size)
    width = b.width or b.ball_diameter
    wall = (
        0.5 * max(b.pitch_diameter - (b.bore or 0.0), (b.outer_diameter or 0.0) - b.pitch_diameter) - 0.25 * b.ball_diameter
    )
    columns = width / size + 0.7 * b.ball_diameter / along
    rows = wall / size + log(size / along) / log(1.25)
    nodes = ceil(columns * max(rows, 3.0))
    return SectionCost(nodes, nodes * _BYTES_PER_NODE, _BASE_S + _SECONDS * (nodes / _NODES) ** _POWER)


def section_faults(scene: Scene) -> list[Mistake]:
    """Elements that no memory holds."""
    cost = section_cost(scene)
    if cost.bytes <= _BYTES_LIMIT:
        return []
    why = (
        f"would take {cost.bytes / 2**30:.1f} GiB for some {cost.nodes} nodes of a ring's section, above "
        f"{_BYTES_LIMIT / 2**30:.0f} GiB: take larger elements, or fewer nodes_per_semi_axis"
    )
    return [Mistake("mesh.element_size", getattr(scene.mesh, "element_size", None), why)]


def seat_faults(scene: Scene) -> list[Mistake]:
    """Seats so soft that they hold nothing."""
    faults = []
    load = abs(scene.load.axial) + sum(abs(force) for force in scene.load.radial)
    load += getattr(scene.excitation, "amplitude_n", 0.0) or 0.0
    b = scene.bearing
    for key, diameter in (("inner_seat", b.bore), ("outer_seat", b.outer_diameter)):
        seat = getattr(scene.supports, key)
        if isinstance(seat, str) or diameter is None or b.width is None:
            continue
        gives = load / (seat * pi * diameter * b.width)
        if gives > _GIVES * b.ball_diameter:
            why = (
                f"gives way by {1e3 * gives:.3g} mm under {load:.4g} N, too much for balls in grooves: check its unit, N/m3 "
                "(500 N/mm3 is 5e11)"
            )
            faults.append(Mistake(f"supports.{key}", seat, why))
    return faults
