"""Processor time of quick tests, a plug-in of pytest: one beyond its budget fails.

It is that of set-up and call, of this process and its children that ended, without what kernels take to be compiled or read and without
fixtures that several tests share, on the machine of the plan's constants: others, and busy ones, take longer for the same work.  What is
beyond the budget is told at the end.  A test that meets something first does not fail: a library that no test before it imported, or what
is kept in the cache from now on.  Another test would have paid for it.  Continuous integration, whose cache is empty, fails none.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from typing import Any

import attrs
import pytest

from raceway.core.jit import clock
from raceway.planning.parts import timed
from raceway.storage.kernel_cache import cache_root

#: Of one quick test [s].
BUDGET_S = 2.0
#: On a machine that others use a test takes up to three times as long: beyond this it is no quick test.
FAILS_S = 3.0 * BUDGET_S
#: Marks of tests that are not quick.
LONG = ("slow", "docs", "night", "release", "ross")
#: So many new modules are a library.
_LIBRARY = 30
CACHE, _KEY = cache_root(), "processor_s"


@attrs.frozen
class Reading:
    """What a test began with: processor time without compiling [s], number of modules, time of day [s]."""

    processor: float
    modules: int
    time: float

    @classmethod
    def now(cls) -> Reading:
        kernels = clock["compile_processor_s"] + clock["load_s"]
        return cls(sum(os.times()[:4]) - kernels - sum(_SHARED), len(sys.modules), time.time())

    def meets_first(self, after: Reading) -> bool:
        """Whether a library was imported or something kept since then."""
        if after.modules - self.modules >= _LIBRARY:
            return True
        places = (os.path.join(folder, name) for folder, _, names in os.walk(CACHE) for name in names)
        return any(os.path.getmtime(place) >= self.time for place in places if os.path.exists(place))


_BEGUN = pytest.StashKey[Reading]()
#: Processor time of set-ups that tests share [s]; one that asks for another is billed without it.
_SHARED: list[float] = []


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[Any]) -> Iterator[Any]:
    before = Reading.now()
    result = yield
    if fixturedef.scope != "function":
        _SHARED.append(Reading.now().processor - before.processor)
    return result


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[Any]:
    item.stash[_BEGUN] = Reading.now()
    return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[Any]:
    result, before, after = (yield), item.stash[_BEGUN], Reading.now()
    seconds = after.processor - before.processor
    quick = not any(item.get_closest_marker(name) for name in LONG)
    if quick and seconds > BUDGET_S and (seconds := seconds / max(timed(), 1.0)) > BUDGET_S:
        first = before.meets_first(after)
        item.user_properties.append((_KEY, (seconds, first)))
        if seconds > FAILS_S and not first and os.environ.get("CI") != "true":
            pytest.fail(
                f"{item.nodeid} takes {seconds:.1f} s of processor time, a quick test at most {BUDGET_S:g} s: give it a smaller case, "
                "or one set-up with its neighbours, or the mark `slow` where a quick test meets the same code",
                pytrace=False,
            )
    return result


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Quick tests beyond the budget, the dearest first."""
    dear = {
        report.nodeid: value
        for reports in terminalreporter.stats.values()
        for report in reports
        for key, value in getattr(report, "user_properties", ())
        if key == _KEY
    }
    for name, (seconds, first) in sorted(dear.items(), key=lambda one: -one[1][0]):
        terminalreporter.write_line(
            f"{seconds:5.1f} s of processor time{', some of it for what is met first' * first}: {name}"
        )
