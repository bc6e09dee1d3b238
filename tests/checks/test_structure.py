"""Measures of structure, on a product of a few lines, and the picture of a run's files."""

import ast
import re
from pathlib import Path

import pytest

from checks import structure
from checks.documents import reading

SMALL = {
    "raceway/scene/a.py": "from raceway.scene.b import load\n\ndef moved(held):\n    return _row(held)\n\ndef _row(x):\n    return x\n",
    "raceway/scene/b.py": "def load():\n    from raceway.scene.a import moved\n    return moved\n\ndef speed():\n    return 1\n",
    "raceway/scene/c.py": "def _row(x):\n    pass\n",
    "raceway/scene/d.py": "def _row(x):\n    pass\n",
    "raceway/scene/e.py": "def _row(x):\n    pass\n",
}


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(structure, "product", lambda: {name: ast.parse(text) for name, text in SMALL.items()})


def test_what_is_counted(small):
    once = [f"raceway/scene/{name}" for name in ("a.py: _row", "b.py: load", "c.py: _row", "d.py: _row", "e.py: _row")]
    assert structure.used_once() == once  # `load` is imported once, `moved` is imported and returned
    single, names, words = structure.participles()
    assert (single, dict(words)) == (2, {"moved": 1, "held": 1})
    assert names == 12
    assert structure.meanings() == ["_row 4"]
    assert [sorted(group) for group in structure.circles()] == [["raceway/scene/a.py", "raceway/scene/b.py"]]


def test_private_names_and_modules_of_the_product():
    files = {
        "tests/x.py": ast.parse("from raceway.scene.a import _row, load\nfrom raceway import run\nfrom checks.y import _z\n")
    }
    assert structure.foreign(files) == ({"raceway.scene.a"}, ["tests/x.py: _row"])


def test_the_picture_names_files_that_there_are():
    text = reading.PICTURE.read_text(encoding="utf-8")
    names = re.findall(r">([\w/]+\.py)<", text)
    assert len(names) > 60
    assert [name for name in names if not (Path(reading.ROOT) / "raceway" / name).is_file()] == []
    assert [step for _, step in reading.STEPS if f">{step}<" not in text] == []
