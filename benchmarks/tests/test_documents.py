"""Documents made from the program are what it says now."""

from __future__ import annotations

import re

from benchmarks.documents import README, SCENE, SHOWN, scene_page, screen, shown_scene, shown_screen


def test_the_scene_page_is_what_the_declarations_say():
    assert SCENE.read_text(encoding="utf-8") == scene_page(), "run python -m benchmarks.documents"


def test_the_readme_shows_the_screen_of_the_scene_that_it_shows():
    # Geometry and equilibrium to every character; elsewhere stand rounding, times and memory of one machine, among the same words.
    def exact(text: str) -> tuple[str, str]:
        return text.partition("Answer at")[0], text.partition("Equilibrium under")[2].partition("Dynamic stiffness")[0]

    def words(text: str) -> str:
        return " ".join(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text).split())

    text = README.read_text(encoding="utf-8")
    assert shown_scene(text) == SHOWN.read_text(encoding="utf-8"), "run python -m benchmarks.documents"
    shown = shown_screen(text)
    assert "tangent kyy" in exact(shown)[1] and "balls of" in exact(shown)[0]
    now = screen()
    assert exact(shown) == exact(now), "run python -m benchmarks.documents"
    assert words(shown) == words(now), "run python -m benchmarks.documents"
