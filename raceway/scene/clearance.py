"""Radial internal clearance by class and bore: ISO 5753-1, ``raceway/data/clearances.csv``."""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

#: Classes of ISO 5753-1 from the smallest; CN is the normal one and not written in designations.
CLASSES = ("C2", "CN", "C3", "C4")


@cache
def _ranges() -> list[dict[str, str]]:
    lines = files("raceway").joinpath("data/clearances.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def clearance_range(kind: str, bore: float, name: str = "CN") -> tuple[float, float] | None:
    """Least and largest radial internal clearance [m], on the diameter; None where the standard has no such bore.

    Parameters
    ----------
    kind : "ball" (deep groove) or "roller" (cylindrical), with cylindrical bores
    bore : [m];  name : one of ``CLASSES``

    References
    ----------
    ISO 5753-1:2009, as printed by two makers (named in the file).
    """
    millimetres = round(1e3 * bore, 6)
    for row in _ranges():
        if row["kind"] == kind and float(row["over"]) < millimetres <= float(row["up_to"]):
            return float(row[f"{name}_min"]) * 1e-6, float(row[f"{name}_max"]) * 1e-6
    return None
