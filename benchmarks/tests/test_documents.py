"""Documents made from the program are what it says now."""

from __future__ import annotations

import re

from benchmarks import reports as files
from benchmarks.documents import (
    COMMANDS,
    DRAWING,
    EXAMPLE,
    README,
    ROOT,
    SCENE,
    SHOWN,
    STABILITY,
    VERSIONS,
    answer,
    commands,
    drawing,
    promises,
    scene_page,
    screen,
    shown_parts,
)
from benchmarks.documents.versions import with_versions
from raceway.scene.schema import keys
from raceway.scene.tables import TABLES


def test_the_scene_page_is_what_the_declarations_say():
    assert SCENE.read_text(encoding="utf-8") == scene_page(), "run python -m benchmarks.documents"


def test_the_readme_shows_the_answer_of_the_scene_that_it_shows():
    # Geometry and K to every character; after it stand rounding, times and memory of one machine, among the same words.
    def exact(text: str) -> str:
        return text.partition("numerical error")[0]

    def words(text: str) -> str:
        return " ".join(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text).split())

    text = README.read_text(encoding="utf-8")
    scene, example, shown = shown_parts(text)
    assert scene == SHOWN.read_text(encoding="utf-8"), "run python -m benchmarks.documents"
    assert example == EXAMPLE.read_text(encoding="utf-8"), "run python -m benchmarks.documents"
    now = answer(screen())
    assert "equivalent stiffness K" in exact(shown) and "balls of" in exact(shown)
    assert exact(shown) == exact(now), "run python -m benchmarks.documents"
    assert words(shown) == words(now), "run python -m benchmarks.documents"


def test_the_page_of_commands_is_what_they_say_of_themselves():
    assert COMMANDS.read_text(encoding="utf-8") == commands.page(), "run python -m benchmarks.documents"
    assert {"raceway run", "raceway study rig"} <= {name for name, _ in commands.walk(commands.main, "raceway")}


def test_the_table_of_versions_is_that_of_the_package():
    text = VERSIONS.read_text(encoding="utf-8")
    assert with_versions(text, ROOT) == text, "run python -m benchmarks.documents"
    assert "numba 0." in text and "extra `docs`" in text


def test_the_drawing_explains_keys_that_there_are(tmp_path):
    assert set(drawing.KEYS) <= {field.name for field in keys(TABLES["bearing"])}
    drawing.draw(tmp_path / "drawn.svg")
    told = texts(DRAWING)
    assert told == texts(tmp_path / "drawn.svg"), "run python -m benchmarks.documents"
    assert not [key for key in drawing.KEYS if not [text for text in told if key in text]]


def test_the_picture_of_stability_is_that_of_the_report(tmp_path):
    promises.draw_stability(files.read()["stability"], tmp_path / "drawn.svg")
    assert texts(STABILITY) == texts(tmp_path / "drawn.svg"), "run python -m benchmarks.documents"
    assert len(texts(STABILITY)) > 20


def texts(path):
    """The texts of a picture: drawn as outlines, each stands as a comment beside its own."""
    return re.findall(r"<!-- (.*?) -->", path.read_text(encoding="utf-8"), re.DOTALL)
