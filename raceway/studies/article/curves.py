"""The numbers of the study by setting: K and |Z| over speed and axial load, and what failed or is in doubt."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import attrs
import numpy as np

from raceway.storage.tables import Tables
from raceway.studies.article.design import CLAIMED, FRICTION_ERROR, Design, Setting

#: What became of a run that is neither failed nor refused.
ANSWERED = ("completed", "unstable", "unsteady")
#: What may be called k: name -> key of a row.
MEASURES = {"K": "k", "|Z|": "abs_z"}


@attrs.frozen(eq=False)
class Curves:
    """All rows.

    Attributes
    ----------
    rows : (setting, axial load) -> one row a speed, in the design's order
    """

    design: Design
    rows: dict[tuple[Setting, float], list[Tables]]

    def values(self, setting: Setting, load: float, measure: str = "K") -> np.ndarray:
        """(speeds,) [N/m]; nan where the run failed or its motion is unstable."""
        key = MEASURES[measure]
        return np.array([row[key] if row["status"] == "completed" else np.nan for row in self.rows[setting, load]])

    def errors(self, setting: Setting, load: float) -> np.ndarray:
        """(speeds,) each run's own relative error, its mesh's apart: that is the same at all speeds.

        With friction at least ``FRICTION_ERROR``: where contacts stick depends on how the motion began.
        """
        least = 0.0 if setting.friction == "none" else FRICTION_ERROR
        return np.array([max(row.get("error") or 0.0, least) for row in self.rows[setting, load]])

    def unstable(self, setting: Setting, load: float, measure: str = "K") -> np.ndarray:
        """(speeds,) [N/m] of unstable motions, nan elsewhere."""
        key = MEASURES[measure]
        return np.array([row[key] if row["status"] == "unstable" else np.nan for row in self.rows[setting, load]])

    def failed(self, setting: Setting, load: float) -> np.ndarray:
        """(speeds,) where the run failed or was refused, so that nobody knows what a ring does."""
        return np.array([row["status"] not in ANSWERED for row in self.rows[setting, load]])

    def surface(self, setting: Setting, measure: str = "K") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values [N/m], errors, and where runs failed; (loads, speeds) each."""
        loads = self.design.loads_of(setting)
        values = np.array([self.values(setting, load, measure) for load in loads])
        errors = np.array([self.errors(setting, load) for load in loads])
        return values, errors, np.array([self.failed(setting, load) for load in loads])

    def normalised(self, setting: Setting, load: float, measure: str = "K") -> np.ndarray:
        """k* = k / k(w_min), (speeds,)."""
        found = self.values(setting, load, measure)
        return np.asarray(found / found[0])

    def why_not(self, setting: Setting, load: float) -> str:
        """What is missing in a curve, in words; "" where nothing is."""
        return told(self.rows[setting, load])

    def faults(self) -> Iterator[Tables]:
        """Every run that gave no number to judge with."""
        for (setting, _), rows in self.rows.items():
            for row in rows:
                if row["status"] != "completed":
                    yield {**attrs.asdict(setting), **row}


def told(rows: list[Tables]) -> str:
    """Runs without a number, counted by what became of them, with the first reason of each kind."""
    bad = [row for row in rows if row["status"] != "completed"]
    parts = []
    for status, count in Counter(row["status"] for row in bad).items():
        reason = next(row["reason"] for row in bad if row["status"] == status)
        speeds = ", ".join(dict.fromkeys(f"{row['speed_rpm']:g}" for row in bad if row["status"] == status))
        parts.append(f"{count} {status} ({speeds} r/min: {reason})")
    return "; ".join(parts)


_PAIRS: list[Tables] = [{"direction": direction, "amplitude": amplitude} for direction, amplitude in CLAIMED]
ONE_WAY, ROTATING = _PAIRS
