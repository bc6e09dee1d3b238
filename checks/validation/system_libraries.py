"""Tests that need what pip does not install: a plug-in of pytest that skips them where it is missing, loudly, or fails them.

``@pytest.mark.needs("ccx")`` names a key of ``NEEDS``.  With ``CI=true`` or ``RACEWAY_TEST_ALL=1`` a missing one is a failure.
"""

import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from raceway import RacewayError


def _programs(*names: str) -> str:
    """Which of ``names`` the path lacks; "" where it has all."""
    missing = [name for name in names if shutil.which(name) is None]
    return f"{' and '.join(missing)} not on the path" if missing else ""


def _gmsh() -> str:
    """Why gmsh cannot be imported; in a process of its own, because a library may end it."""
    done = subprocess.run([sys.executable, "-c", "import gmsh"], capture_output=True, text=True, timeout=60, check=False)
    # A package that pip has not installed is a mistake of the installation, which the tests themselves tell.
    if done.returncode == 0 or "ModuleNotFoundError" in done.stderr:
        return ""
    return (done.stderr.strip().splitlines() or [f"its import ended with {done.returncode}"])[-1]


def _pictures() -> str:
    """Why VTK cannot draw."""
    from raceway_view.system_libraries import refuse_pictures

    try:
        refuse_pictures()
    except RacewayError as fault:
        return str(fault)
    return ""


#: What a test may need -> what it is called, and a function that tells why it is missing ("" where it is there).
NEEDS: dict[str, tuple[str, Callable[[], str]]] = {
    "gmsh": ("gmsh's system libraries", _gmsh), "pyvista": ("pyvista's system libraries", _pictures),
    "browser": ("a browser (chromium with chromedriver)", lambda: _programs("chromium", "chromedriver")),
    "ccx": ("CalculiX (ccx)", lambda: _programs("ccx")),
}  # fmt: skip
_REASON = "missing: "


@cache
def missing(name: str) -> str:
    """Why what ``NEEDS`` calls ``name`` cannot be used; "" where it can."""
    return NEEDS[name][1]()


def install_line() -> str:
    """The line that installs all of ``NEEDS`` on Debian, which the Makefile keeps."""
    text = (Path(__file__).resolve().parents[2] / "Makefile").read_text(encoding="utf-8")
    packages = re.search(r"^APT_PACKAGES := (.*)$", text, re.MULTILINE)
    assert packages is not None
    return f"apt-get install -y --no-install-recommends {packages[1]}"


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Before any fixture: a test whose needs are missing is skipped, or fails."""
    names = [name for marker in item.iter_markers("needs") for name in marker.args]
    lacking = [NEEDS[name][0] for name in dict.fromkeys(names) if missing(name)]
    if not lacking:
        return
    reason = _REASON + ", ".join(lacking)
    if os.environ.get("CI") == "true" or os.environ.get("RACEWAY_TEST_ALL") == "1":
        why = "; ".join(missing(name) for name in dict.fromkeys(names) if missing(name))
        pytest.fail(f"{reason} ({why}). As root: {install_line()}", pytrace=False)
    pytest.skip(reason)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """One closing line: how many tests were skipped, why, and what installs the rest."""
    skipped = [report.longrepr[2] for report in terminalreporter.stats.get("skipped", ())]
    found = Counter(what for reason in skipped if _REASON in reason for what in reason.split(_REASON)[1].split(", "))
    count = sum(_REASON in reason for reason in skipped)
    if count:
        why = ", ".join(f"{what} ({number})" for what, number in sorted(found.items()))
        told = (
            f"NOT TESTED: {count} tests were skipped, this machine lacks {why}; as root, to test them too: {install_line()}"
        )
        terminalreporter.write_line(told, yellow=True, bold=True)
