"""Docstrings of the package name what is there."""

import builtins
import re
import subprocess
from collections import Counter
from functools import cache, cached_property
from pathlib import Path

import attrs
import pytest

import raceway

ROOT = Path(__file__).resolve().parents[1]


@attrs.frozen(slots=False)
class Source:
    """A module: its place, its path below ``raceway`` or beside it, and text."""

    place: Path
    path: Path
    text: str

    @cached_property
    def docstrings(self) -> list[str]:
        """Of the module, its classes and functions."""
        return DOCSTRING.findall(self.text)

    @cached_property
    def words(self) -> set[str]:
        """Of the code and of the module itself: without docstrings and comments."""
        code = DOCSTRING.sub("", self.text)
        return {*re.findall(r"\w+", re.sub(r"(?<!\S)#.*", "", code)), *self.path.with_suffix("").parts}


@cache
def source(path: Path) -> Source:
    text = path.read_text(encoding="utf-8")
    own = ROOT / "raceway"
    beside = ROOT.joinpath(*path.relative_to(ROOT).parts[:2])
    return Source(path, path.relative_to(own if path.is_relative_to(own) else beside), text)


PATHS = [*sorted((ROOT / "raceway").rglob("*.py")), *sorted(ROOT.glob("packages/*/raceway_*/**/*.py"))]
#: A text at the beginning of a line; syntax trees take thirty times as long.
DOCSTRING = re.compile(r'^ *r?"""(.*?)"""', re.MULTILINE | re.DOTALL)
#: In a docstring: ``word``, ``module.name``.
NAME = re.compile(r"``([A-Za-z_]\w*(?:\.\w+)*)``")
#: Of other programs, columns of tables, meshes that users name.
FOREIGN = {"nohup", "Dw_mm", "ball_0"}
#: A line of a package's docstring, ``name, name  words``, or what follows in it: ``;  name: words``.
ENTRY = re.compile(r"^((?:\w+, )*\w+)(?=  +\S)|;  ((?:\w+, )*\w+):", re.MULTILINE)


@cache
def words() -> dict[str, set[str]]:
    """Of each module, by its path."""
    return {source(path).path.as_posix(): source(path).words for path in PATHS}


def missing(name: str) -> bool:
    """Whether ``raceway.module.thing`` does not exist."""
    parts = name.split(".")[1:]
    for count in range(len(parts), -1, -1):
        for path in ("/".join(parts[:count]) + ".py", "/".join([*parts[:count], "__init__.py"])):
            if path in words():
                return not set(parts[count:]) <= {*words()[path], *(raceway.__all__ if count == 0 else ())}
    return True


def test_names_in_docstrings_are_there():
    known = set().union(*words().values(), dir(builtins), raceway.__all__, FOREIGN)
    names = [
        (module.path.as_posix(), name)
        for module in map(source, PATHS)
        for text in module.docstrings
        for name in NAME.findall(text)
    ]
    assert len(names) > 1000
    gone = [
        (path, name)
        for path, name in names
        if (missing(name) if name.startswith("raceway.") else not set(name.split(".")) <= known)
    ]
    assert gone == []


@pytest.mark.parametrize(
    "place", [path for path in PATHS if path.name == "__init__.py"], ids=lambda path: str(path.relative_to(ROOT))
)
def test_a_package_lists_its_modules_once_each_and_names_what_is_in_it(place):
    module = source(place)
    folder, text = module.path.parent, module.docstrings[0]
    listed = Counter(name for heads in ENTRY.findall(text) for name in "".join(heads).split(", "))
    present = {p.stem for p in module.place.parent.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()}
    public = {"data", *raceway.__all__} if folder == Path() else {"data"}
    assert set(listed) - public == present - {"__init__", "__main__"} and max(listed.values()) == 1
    own = set().union(*(found for path, found in words().items() if Path(path).parent == folder), raceway.__all__)
    names = [name for name in NAME.findall(text) if not name.startswith("raceway.")]
    assert [name for name in names if not set(name.split(".")) <= own | {"raceway", *listed}] == []


def test_no_module_of_several_plug_ins_is_called_by_the_name_of_one():
    several = 0
    for module in map(source, PATHS):
        names = [name.replace("_", " ") for name in re.findall(r'^    name: ClassVar\[str\] = "(\w+)"', module.text, re.M)]
        several += len(names) > 1
        called = [name for name in names if module.docstrings[0].lower().startswith(name)]
        assert len(names) < 2 or len(called) != 1, module.path
    assert several > 3


def test_no_file_holds_a_mark_of_a_merge():
    mark = "^(<{7} |={7}$|>{7} |[|]{7} )"
    found = subprocess.run(["git", "grep", "-InE", mark], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stdout) == (1, ""), found.stderr
