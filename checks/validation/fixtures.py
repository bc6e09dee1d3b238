"""What several test files share: scenes as plain tables, built models."""

from typing import Any

import pytest
from matplotlib.figure import Figure

from checks.validation.figures import outside
from raceway import build_model, scene_from_dict
from raceway.testing import Model, b7206c, default_registry


@pytest.fixture
def tables():
    """``tables(load={...})``: a scene's tables on the B7206C."""
    return b7206c


@pytest.fixture
def built():
    """``built(load={...})``: the model of a scene on the B7206C."""

    def build(**tables: Any) -> Model:
        return build_model(scene_from_dict(b7206c(**tables)))

    return build


@pytest.fixture(autouse=True)
def plug_ins_leave_with_their_test():
    """One-off files stay in the registry of the process: the next test would meet them."""
    registry = default_registry()
    plugins, entries = set(registry.manager.get_plugins()), {key: list(found) for key, found in registry.entries.items()}
    yield
    for plugin in set(registry.manager.get_plugins()) - plugins:
        registry.manager.unregister(plugin)
    registry.entries.clear()
    registry.entries.update(entries)


@pytest.fixture
def all_pixels():
    """Pictures are written with the dots per inch that users get."""


@pytest.fixture(autouse=True)
def nothing_is_drawn_outside_its_axes(monkeypatch, request):
    """Every figure that a test draws is looked at, whatever the test is about; it has few pixels, which are half of its time."""
    found, draw, set_dpi = list[str](), Figure.draw, Figure.set_dpi

    def looked_at(self: Figure, renderer: Any) -> None:
        draw(self, renderer)
        found.extend(outside(self))

    monkeypatch.setattr(Figure, "draw", looked_at)
    if "all_pixels" not in request.fixturenames:
        monkeypatch.setattr(Figure, "set_dpi", lambda figure, dpi: set_dpi(figure, min(dpi, 80.0)))
    yield
    assert not found, found[:5]
