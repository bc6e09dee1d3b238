"""The tables of the scene that most tests vary."""

from __future__ import annotations

from typing import Any


def b7206c(**tables: Any) -> dict[str, Any]:
    """The tables of a B7206C under 1000 N; each keyword replaces or extends one table."""
    scene: dict[str, Any] = {"title": "test", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    for name, table in tables.items():
        scene[name] = {**scene.get(name, {}), **table} if isinstance(table, dict) else table
    return scene
