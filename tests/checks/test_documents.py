"""Documents made from the program are what it says now."""

import re

from click.testing import CliRunner

from checks import documents
from checks import reports as files
from checks.documents import commands, drawing, packages, promises
from checks.documents.versions import with_versions
from raceway.cli.main import main
from raceway.cli.schema import keys
from raceway.scene.tables import TABLES


def test_the_scene_page_is_what_the_declarations_say():
    assert documents.SCENE.read_text(encoding="utf-8") == documents.scene_page(), "run python -m checks.documents"


def test_the_readme_shows_the_answer_of_the_scene_that_it_shows(tmp_path):
    # Geometry and K to every character; after it stand rounding, times and memory of one machine, among the same words.
    def exact(text: str) -> str:
        return text.partition("numerical error")[0]

    def words(text: str) -> str:
        return " ".join(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text).split())

    text = documents.README.read_text(encoding="utf-8")
    scene, example, shown = documents.shown_parts(text)
    assert scene == documents.SHOWN.read_text(encoding="utf-8"), "run python -m checks.documents"
    assert example == documents.EXAMPLE.read_text(encoding="utf-8"), "run python -m checks.documents"
    words_of_a_run = ["run", str(documents.SHOWN), "--out", str(tmp_path)]
    # The first run may compile, and says so.
    _, ran = (CliRunner(env={"COLUMNS": "80", "NO_COLOR": "1"}).invoke(main, words_of_a_run) for _ in range(2))
    now = documents.answer("\n".join(line.rstrip() for line in ran.stdout.splitlines() if line[:8] != "written:") + "\n")
    assert "equivalent stiffness K" in exact(shown) and "balls of" in exact(shown)
    assert exact(shown) == exact(now), "run python -m checks.documents"
    assert words(shown) == words(now), "run python -m checks.documents"


def test_the_page_of_commands_is_what_they_say_of_themselves():
    assert documents.COMMANDS.read_text(encoding="utf-8") == commands.page(), "run python -m checks.documents"
    assert {"raceway run", "raceway study rig"} <= {name for name, _ in commands.walk(commands.main, "raceway")}


def test_the_stub_and_the_list_of_packages_are_what_they_declare():
    assert all(path.read_text(encoding="utf-8") == text for path, text in packages.declared().items())


def test_the_table_of_versions_is_that_of_the_package():
    text = documents.VERSIONS.read_text(encoding="utf-8")
    assert with_versions(text, documents.ROOT) == text, "run python -m checks.documents"
    assert "numba 0." in text and "extra `docs`" in text


def test_the_drawing_explains_keys_that_there_are(tmp_path):
    assert set(drawing.KEYS) <= {field.name for field in keys(TABLES["bearing"])}
    drawing.draw(tmp_path / "drawn.svg")
    told = texts(documents.DRAWING)
    assert told == texts(tmp_path / "drawn.svg"), "run python -m checks.documents"
    assert not [key for key in drawing.KEYS if not [text for text in told if key in text]]


def test_the_picture_of_stability_is_that_of_the_report(tmp_path):
    promises.draw_stability(files.read()["stability"], tmp_path / "drawn.svg")
    assert texts(documents.STABILITY) == texts(tmp_path / "drawn.svg"), "run python -m checks.documents"
    assert len(texts(documents.STABILITY)) > 20


def texts(path):
    """The texts of a picture: drawn as outlines, each stands as a comment beside its own."""
    return re.findall(r"<!-- (.*?) -->", path.read_text(encoding="utf-8"), re.DOTALL)
