"""``raceway study map``: hardening or softening of k(speed) over axial load, tilt boundary and contact angle.

Only ``raceway.pipeline.run.run`` is called, on variations of one scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.simulate import OnProgress
from raceway.storage.tables import Tables
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, row_key
from raceway.studies.map.curves import LEVEL, SATURATED, curves, words
from raceway.studies.map.design import Design, amplitude_words
from raceway.studies.map.point import point_row

#: Points above which processes of their own are worth their start: importing the program takes as long as a hundred.
_WORTH = 150


@attrs.frozen(eq=False)
class Map:
    """A finished map.

    Attributes
    ----------
    rows : in the design's order, each with its point;  curves : see ``curves``
    fault : why rows could not be kept; None where they were
    """

    design: Design
    amplitude: str
    rows: list[Tables]
    curves: list[Tables]
    words: list[str]
    fault: RacewayError | None = None

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        tables = self.design.tables
        return {
            "title": tables.get("title", "scene"),
            "method": self.design.method,
            "amplitude": self.amplitude,
            "definitions": definitions(self.design.method),
            "axes": {key: list(values) for key, values in self.design.axes.items()},
            "scene": tables,
            "words": self.words,
            "curves": self.curves,
            "rows": self.rows,
        }


def definitions(method: str) -> dict[str, str]:
    """Definitions of the numbers of a map."""
    how = {
        "quasi_static": "secant: 1x line of the force over that of the displacement, the orbit as a series of equilibria "
        "under the force as given; the contacts carry just this force",
        "periodic": "K = Re Z + m w^2 on the steady orbit with the inertia of ring and rotor; the contacts carry the force "
        "and what the mass adds",
    }
    return {
        "stiffness": how[method],
        "change": "k(w) / k(w0) - 1, w0 the lowest speed of the curve",
        "exponent": "d ln k / d ln w between a speed and the next lower one",
        "trend": f"signs of the exponent in their order; closer to 0 than {LEVEL:g} is level",
        "saturates": f"first speed past the largest exponent with less than {SATURATED:g} of it",
        "small_signal": "tangent at rest at this speed, free coordinates let go: what ball inertia and ring growth do alone",
        "lost": "balls that leave the inner race at some time of a turn",
        "reach": "farthest end of a contact ellipse over the groove's edge, both as angles from the groove's bottom; above 1 "
        "the ellipse is cut off in reality, and the stiffness is too high",
        "unseats": "the contact angle of a loaded ball falls to zero or below",
    }


def study_map(
    design: Design,
    processes: int = 0,
    kept: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> Map:
    """Run every point that is not kept already.

    Parameters
    ----------
    processes : that work at a time; 0: in this one
    kept : file of finished rows, read and added to

    Notes
    -----
    A point that is refused or that fails is kept with its reason, and the study goes on.
    """
    registry = registry or default_registry()
    points, store = design.points(), RowStore(kept)
    items = [
        Item(row_key(design.scene(point, registry), registry, "map"), "points of the map", (design, point))
        for point in points
    ]
    worth = sum(store.get(item.key) is None for item in items) >= _WORTH
    executor = local(registry, processes if worth and processes > 1 else 0)
    done, _ = work_through(row_at, items, store, executor, registry, plugins, on_progress)
    rows = [{"point": point, **row} for point, row in zip(points, done, strict=True)]
    found = curves(rows)
    amplitude = amplitude_words(design.scene(points[0], registry))
    return Map(design, amplitude, rows, found, words(found, rows), store.fault)


def row_at(given: tuple[Design, Tables], registry: Registry) -> Tables:
    """The row of one point of a design."""
    design, point = given
    return point_row(design.scene(point, registry), registry)
