"""What several test files share: scenes as plain tables, built models."""

from __future__ import annotations

from typing import Any

import pytest

from raceway import build_model, make_plan, scene_from_dict
from raceway.model import Model


def b7206c(**tables: Any) -> dict[str, Any]:
    """The tables of a B7206C under 1000 N; each keyword replaces or extends one table."""
    scene: dict[str, Any] = {"title": "test", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    for name, table in tables.items():
        scene[name] = {**scene.get(name, {}), **table} if isinstance(table, dict) else table
    return scene


@pytest.fixture
def tables():
    """``tables(load={...})``: a scene's tables on the B7206C."""
    return b7206c


@pytest.fixture
def built():
    """``built(load={...})``: the model of a scene on the B7206C."""

    def build(**tables: Any) -> Model:
        scene = scene_from_dict(b7206c(**tables))
        return build_model(scene, make_plan(scene))

    return build
