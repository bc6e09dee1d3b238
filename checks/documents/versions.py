"""docs/installation.md: the table of Python versions and of the oldest packages, from pyproject.toml."""

import re
import tomllib
from pathlib import Path

_BLOCK = re.compile(r"(<!-- versions -->\n)(.*?)(<!-- /versions -->)", re.DOTALL)
_REQUIREMENT = re.compile(r"([A-Za-z0-9_.-]+)(\[.*\])?(.*)")


def with_versions(text: str, root: Path) -> str:
    """The page with its table made anew."""
    files = [root / "pyproject.toml", *sorted(root.glob("packages/*/pyproject.toml"))]
    project, *packages = (tomllib.loads(file.read_text(encoding="utf-8"))["project"] for file in files)
    needs = {one["name"]: [text for text in one["dependencies"] if not text.startswith("raceway")] for one in packages}
    rows = "".join(f"| {name} | {_packages(needed)} |\n" for name, needed in needs.items() if needed)
    return _BLOCK.sub(lambda match: match[1] + table(project) + rows + match[3], text)


def table(project: dict[str, object]) -> str:
    """Python, the base installation, and each extra."""
    classifiers, extras = project["classifiers"], project["optional-dependencies"]
    assert isinstance(classifiers, list) and isinstance(extras, dict)
    pythons = [word.rpartition(" ")[2] for word in classifiers if re.search(r"Python :: 3\.\d+$", word)]
    rows = ["| part | what it needs |", "|---|---|", f"| Python | {', '.join(pythons)}, each tried |"]
    rows += [f"| installed always | {_packages(project['dependencies'])} |"]
    rows += [f"| extra `{name}` | {_packages(needed)} |" for name, needed in extras.items() if name != "dev"]
    return "\n".join(rows) + "\n"


def _packages(requirements: object) -> str:
    assert isinstance(requirements, list)
    words = []
    for requirement in requirements:
        found = _REQUIREMENT.fullmatch(requirement.replace(" ", ""))
        assert found is not None, requirement
        name, inner, bounds = found.groups()
        words.append(
            f"the extras {inner[1:-1].replace(',', ', ')}"
            if name == "raceway" and inner
            else f"{name} {_said(bounds)}".strip()
        )
    return ", ".join(words)


def _said(bounds: str) -> str:
    """ ">=1.12" is "1.12 or later"; "<7" is "before 7"."""
    said = []
    for bound in filter(None, bounds.split(",")):
        for sign, words in ((">=", "{} or later"), ("<", "before {}"), ("==", "{}")):
            if bound.startswith(sign):
                said.append(words.format(bound.removeprefix(sign)))
                break
        else:
            said.append(bound)
    return " and ".join(said)
