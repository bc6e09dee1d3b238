"""The table of faults."""

import tomllib
from pathlib import Path

import attrs

ROOT = Path(__file__).resolve().parents[2]
TABLE = Path(__file__).with_name("faults.toml")


@attrs.frozen
class Fault:
    """One line made wrong.

    file : path from the root of the sources
    was, becomes : text, which occurs once in the file, and what replaces it
    tests : files or nodes of pytest that must catch it
    does : what the fault does to a user's numbers
    """

    file: str
    was: str
    becomes: str
    tests: tuple[str, ...]
    does: str

    def put(self, source: str) -> str:
        """The file's text with the fault in it; ValueError: the text to replace does not occur, or more than once."""
        if source.count(self.was) != 1:
            raise ValueError(f"{self.file}: `{self.was}` occurs {source.count(self.was)} times, must be once")
        return source.replace(self.was, self.becomes)

    def misplaced(self) -> str:
        """Why it does not fit the sources, and where its text stands now; empty where it fits."""
        path = ROOT / self.file
        try:
            self.put(path.read_text(encoding="utf-8") if path.is_file() else "")
        except ValueError as why:
            files = [
                path
                for path in [*sorted((ROOT / "raceway").rglob("*.py")), *sorted(ROOT.glob("packages/*/raceway_*/**/*.py"))]
                if self.was in path.read_text(encoding="utf-8")
            ]
            return f"{why}; it stands in {', '.join(str(path.relative_to(ROOT)) for path in files) or 'no file'}"
        missing = [test for test in self.tests if not _exists(test)]
        return f"{self.file}: there is no {', '.join(missing)}" if missing else ""


def _exists(test: str) -> bool:
    """Whether there is a file, and a function in it, of a name that pytest takes."""
    name, _, node = test.partition("::")
    path = ROOT / name
    return path.is_file() and (not node or f"def {node.partition('[')[0]}(" in path.read_text(encoding="utf-8"))


def read_faults(path: Path = TABLE) -> list[Fault]:
    """All faults, in the order of the table."""
    with path.open("rb") as file:
        rows = tomllib.load(file)["fault"]
    return [Fault(**{**row, "tests": tuple(row["tests"])}) for row in rows]


def chosen(words: list[str], table: Path = TABLE) -> list[Fault]:
    """The faults whose file or effect holds one of the words; all without words."""
    return [fault for fault in read_faults(table) if not words or any(w in f"{fault.file} {fault.does}" for w in words)]
