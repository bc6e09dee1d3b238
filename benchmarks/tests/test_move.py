"""Modules moved and merged in a small repository: it imports and answers as before."""

from __future__ import annotations

import subprocess
import sys

import pytest

from benchmarks.move import move

FILES = {
    "house/__init__.py": "",
    "house/a.py": '"""Of a."""\nfrom __future__ import annotations\n\nimport math\n\nfrom house.b import half\n\n\ndef area(r):\n'
    "    return 2.0 * half(math.pi) * r**2\n",
    "house/b.py": '"""Of b."""\nimport math\n\nTWO = math.sqrt(4.0)\n\n\ndef half(x):\n    return x / TWO\n',
    "house/room/__init__.py": "",
    "house/room/door.py": "def width():\n    from house.b import TWO\n\n    return TWO\n",
    "use.py": "from house import a, b\nfrom house.room import door\nfrom house.room.door import width\n\n"
    'print(a.area(1.0), b.TWO, door.width(), width(), "house.b.TWO")\n',
    "README.md": "See `house.room.door` (house/room/door.py) and `house.room`.\n",
}


@pytest.fixture
def house(tmp_path):
    for path, text in FILES.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    for words in (["init", "-q"], ["add", "."]):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    return tmp_path


def printed(house):
    return subprocess.run([sys.executable, "use.py"], cwd=house, capture_output=True, text=True, check=True).stdout


def test_a_merge_and_a_move(house):
    before = printed(house)
    # `area` needs `half`, so b's body comes first, whatever the order of the sources.
    move(house, {"house/a.py": "house/circle.py", "house/b.py": "house/circle.py", "house/room/door.py": "house/gate.py"})
    assert printed(house) == before.replace("house.b.TWO", "house.circle.TWO")
    text = (house / "house" / "circle.py").read_text(encoding="utf-8")
    assert "house." not in text and text.startswith('"""Of a."""') and text.count("import math") == 1
    assert (house / "README.md").read_text(encoding="utf-8") == "See `house.gate` (house/gate.py) and `house.room`.\n"
    assert not any((house / path).exists() for path in ("house/a.py", "house/b.py", "house/room/door.py"))


def test_a_name_that_both_define_is_refused_and_nothing_changes(house):
    (house / "house" / "b.py").write_text("def area():\n    return 0\n", encoding="utf-8")
    with pytest.raises(ValueError, match="both define `area`"):
        move(house, {"house/a.py": "house/circle.py", "house/b.py": "house/circle.py"})
    assert (house / "house" / "a.py").read_text(encoding="utf-8") == FILES["house/a.py"]
