"""Claims: numbers that tests hold against limits, and that ``pytest --evidence`` writes to docs/reports, one report a module.

``claim(quantity, value, near=2.95, within=0.01, basis="published", source="...")`` is a fixture: it asserts, and its rows stand in
the module's report.  A module is one report and belongs to one tier: quick (no mark), ``night`` or ``release``.  Evidence is made of a
commit: with uncommitted changes, or of a part of a module, nothing is written.

No quick test is decided by the clock: a claim in a unit of time, or of a machine, is made by tests of night and release.

A row that misses its limits says why (``misses=``), and fails once it holds, so that the reason goes.  Only where the value depends on
the machine (``machine=True``: processor times and their ratios) the reason is left out where the row holds.
"""

import ast
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import pytest

from checks import reports as files

#: What a limit rests on; README shows the first three.
BASES = (*files.OUTSIDE, "own other method", "regression")
#: Units of times that a machine takes.
_TIMES = {"s", "CPU s", "ms", "us"}


@attrs.frozen
class Claim:
    """One row of a report.

    quantity, value, unit : what was computed
    low, high : its limits; None where there is none at that end
    basis, source : what the limits rest on: one of ``BASES``, and where it stands or why the tolerance is what it is
    seconds : processor time since the row before, or the test's beginning
    misses : why the value is outside; empty where it is inside
    """

    quantity: str
    value: float
    unit: str
    low: float | None
    high: float | None
    basis: str
    source: str
    seconds: float
    misses: str = ""

    @property
    def holds(self) -> bool:
        return (self.low is None or self.value >= self.low) and (self.high is None or self.value <= self.high)

    @property
    def limits(self) -> str:
        """In words of a message."""
        low, high = ("" if end is None else f"{end:.6g}" for end in (self.low, self.high))
        return f"{low} to {high}" if low and high else f"at least {low}" if low else f"at most {high}"


def limits_of(
    near: float | None, within: float | None, at_least: float | None, at_most: float | None
) -> tuple[float | None, float | None]:
    """Both ends; ``within`` is relative to ``near``.  TypeError: no limit, or both ways at once."""
    if (near is None) != (within is None) or (near is not None) == (at_least is not None or at_most is not None):
        raise TypeError("a claim has `near` with `within`, or `at_least`, `at_most` or both")
    if near is None or within is None:
        return at_least, at_most
    return near - within * abs(near), near + within * abs(near)


@pytest.fixture
def claim(request: pytest.FixtureRequest) -> Callable[..., None]:
    """``claim(quantity, value, near=, within=, at_least=, at_most=, unit=, basis=, source=, misses=, machine=)``: see ``Claim``."""
    by_night = any(request.node.get_closest_marker(tier) for tier in ("night", "release"))
    return claims_into(request.node.user_properties, by_night)


def _cpu_s() -> float:
    """Processor time of this process and of its children that ended [s]."""
    return sum(os.times()[:4])


def claims_into(properties: list[tuple[str, Any]], by_night: bool = True) -> Callable[..., None]:
    """What the fixture is: asserts a claim, and appends its row to the properties of a test, quick where not ``by_night``."""
    before = _cpu_s()

    def claim(
        quantity: str,
        value: float,
        *,
        basis: str,
        source: str = "",
        unit: str = "",
        near: float | None = None,
        within: float | None = None,
        at_least: float | None = None,
        at_most: float | None = None,
        misses: str = "",
        machine: bool = False,
    ) -> None:
        nonlocal before
        if basis not in BASES:
            raise TypeError(f"basis {basis!r} is none of {', '.join(BASES)}")
        if not by_night and (machine or unit in _TIMES):
            raise TypeError(f"`{quantity}` depends on the machine: mark its test `night`")
        now = _cpu_s()
        # Numbers of numpy do not travel from a worker's process.
        low, high = (limit if limit is None else float(limit) for limit in limits_of(near, within, at_least, at_most))
        row = Claim(quantity, float(value), unit, low, high, basis, source, round(now - before, 2), misses)
        if machine and row.holds:
            row = attrs.evolve(row, misses="")
        before = now
        assert math.isfinite(row.value), f"{quantity} = {row.value}"
        assert row.holds or row.misses, f"{quantity} = {row.value:.6g} {unit}: {row.limits}"
        assert not (row.holds and row.misses), (
            f"{quantity} = {row.value:.6g} {unit} holds ({row.limits}): take `misses` away"
        )
        properties.append(("claim", attrs.asdict(row)))

    return claim


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--evidence", action="store_true", help="write the claims of whole modules to docs/reports; of a clean commit"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse what would give reports of a part of a module, or of no commit."""
    if not config.option.evidence:
        return
    if config.option.keyword or any("::" in word for word in config.args):
        raise pytest.UsageError("--evidence writes whole modules: without -k and without ::")
    if files.commit() is None:
        raise pytest.UsageError("--evidence is made of a commit: there are uncommitted changes, or there is no repository")
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(_Reports(), "reports of claims")


class _Reports:
    """Gathers rows by module, also from worker processes, and writes the reports of modules without a failure or a skipped test."""

    def __init__(self) -> None:
        self.rows: dict[str, list[tuple[int, str, int, dict[str, Any]]]] = {}
        self.failed: set[str] = set()
        self.seconds: dict[str, float] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        module = report.nodeid.partition("::")[0]
        self.seconds[module] = self.seconds.get(module, 0.0) + report.duration
        if report.failed or report.skipped:
            self.failed.add(module)
        if report.when == "call":
            rows = [row for key, row in report.user_properties if key == "claim"]
            line = report.location[1] or 0
            self.rows.setdefault(module, []).extend((line, report.nodeid, k, row) for k, row in enumerate(rows))

    @pytest.hookimpl(trylast=True)
    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        for module, keyed in sorted(self.rows.items()):
            rows = [row for *_, row in sorted(keyed, key=lambda item: item[:3])]
            if not rows or module in self.failed:
                continue
            name = Path(module).stem.removeprefix("test_")
            source = (files.ROOT / module).read_text(encoding="utf-8")
            title = (ast.get_docstring(ast.parse(source)) or name).splitlines()[0].rstrip(".")
            seconds = self.seconds[module]
            files.write(name, title, rows, seconds, f"pytest --evidence {module}")
            held = sum(not row["misses"] for row in rows)
            terminalreporter.write_line(f"report {name}: {held} of {len(rows)} claims hold, {seconds:.1f} s")
        files.refresh()
