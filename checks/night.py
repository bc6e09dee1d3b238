"""``python -m checks.night``: evidence of the commit that is checked out, made in a work tree of its own, as one commit.

Its message lists the verdicts that changed, and the values that changed by more than 2 %.  The numbers are those of the commit:
what is edited meanwhile changes nothing.
"""

import argparse
import datetime
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from checks import reports as files

#: A value that changed by more is worth a line.
_WORTH = 0.02

Reports = dict[str, dict[str, Any]]


def changes(before: Reports, after: Reports) -> list[str]:
    """A line for each verdict that changed, row that came or went, and value that changed by more than 2 %."""
    lines = []
    for name, data in after.items():
        old = {row["quantity"]: row for row in before.get(name, {"rows": []})["rows"]}
        now = {row["quantity"]: row for row in data["rows"]}
        lines += [f"{name}: no longer there: {quantity}" for quantity in old if quantity not in now]
        for quantity, row in now.items():
            if quantity not in old:
                lines.append(f"{name}: new: {quantity} = {files.shown(row['value'])}")
                continue
            a, b = old[quantity]["value"], row["value"]
            same = files.holds(old[quantity]) == files.holds(row)
            verdict = "" if same else f", {'holds' if files.holds(row) else 'MISSES'} now"
            far = isinstance(a, float) and isinstance(b, float) and abs(b - a) > _WORTH * abs(a)
            if verdict or far:
                lines.append(f"{name}: {quantity}: {files.shown(a)} -> {files.shown(b)}{verdict}")
    return lines


def make(tree: Path, release: bool) -> int:
    """All tests of a work tree, and the reports of their claims; pytest's exit code."""
    tier = "not ross" if release else "not release and not ross"
    words = ["-n", "2", "--dist", "loadgroup", "-q", "--evidence", "-m", tier]
    return subprocess.run([sys.executable, "-m", "pytest", *words], cwd=tree).returncode


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m checks.night", description="Make evidence of the commit that is checked out, as one commit."
    )
    parser.add_argument("--release", action="store_true", help="the article's mesh and study, too: hours")
    asked = parser.parse_args(words)
    made_at = files.commit()
    if made_at is None:
        print("evidence is made of a commit: there are uncommitted changes, or there is no repository", file=sys.stderr)
        return 2
    before = files.read()
    with tempfile.TemporaryDirectory(prefix="raceway-evidence-") as folder:
        tree = Path(folder) / "tree"
        _git("worktree", "add", "--detach", str(tree), made_at)
        try:
            code = make(tree, asked.release)
            after = files.read(tree / "docs" / "reports")
            for name in after:
                shutil.copy2(tree / "docs" / "reports" / f"{name}.json", files.FOLDER)
            shutil.copytree(tree / "docs" / "pictures", files.ROOT / "docs" / "pictures", dirs_exist_ok=True)
        finally:
            _git("worktree", "remove", "--force", str(tree))
    files.refresh()
    lines = changes(before, after)
    print("\n".join(lines))
    head = f"Evidence of {datetime.datetime.now(datetime.UTC):%Y-%m-%d} at {made_at}"
    _git("add", "docs", "README.md")
    _git("commit", "-q", "--allow-empty", "-m", "\n".join([head, "", *(lines or ["No verdict and no value changed."])]))
    return code


def _git(*words: str) -> None:
    subprocess.run(["git", *words], cwd=files.ROOT, check=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
