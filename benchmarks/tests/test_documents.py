"""Documents made from the program are what it says now."""

from __future__ import annotations

import re

from benchmarks.documents import README, SCENE, SHOWN, scene_page, screen, shown_scene, shown_screen


def test_the_scene_page_is_what_the_declarations_say():
    assert SCENE.read_text(encoding="utf-8") == scene_page(), "run python -m benchmarks.documents"


def test_the_readme_shows_the_screen_of_the_scene_that_it_shows():
    # Down to the tangents every character; below stand rounding, times and memory of one machine, among the same words.
    def top(text: str) -> str:
        return text.partition("Dynamic stiffness at")[0]

    def words(text: str) -> str:
        return " ".join(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text.partition("Dynamic stiffness at")[2]).split())

    text = README.read_text(encoding="utf-8")
    assert shown_scene(text) == SHOWN.read_text(encoding="utf-8"), "run python -m benchmarks.documents"
    shown = shown_screen(text)
    assert "tangent kyy" in top(shown)
    now = screen()
    assert top(shown) == top(now), "run python -m benchmarks.documents"
    assert words(shown) == words(now), "run python -m benchmarks.documents"
