"""``raceway app`` in headless chromium: time from a change to its picture, start, memory, and numbers beside those of runs."""

from __future__ import annotations

import os
import statistics
import tempfile
import threading
from pathlib import Path

from raceway_app.session import Session
from raceway_app.worker import Job, News, Worker

from checks.robustness import Row, below
from checks.validation.browser.application import WIDTHS, Application, Tab, hurry, proportional_memory
from checks.validation.browser.chromium import Browser
from raceway.extend import as_given

COMMAND = "python -m checks app"
SCENE = "examples/b7206.toml"
_SEQUENCES, _CHANGES, _DRAGS = 20, 10_000, 60


def rows() -> list[Row]:
    browser = Browser()
    try:
        with tempfile.TemporaryDirectory() as folder, Application(Path(folder), SCENE) as served:
            tab = Tab(browser, served.address)
            start = served.elapsed()
            times = sorted(tab.drag("load.axial", 700 + 10 * k) for k in range(_DRAGS))
            tab.press("Compare two scenes")
            tab.settle()
            both = sorted(tab.drag("load.axial", 700 + 10 * k) for k in range(_DRAGS))
            tab.press("Compare two scenes")
            page = tab.memory()
            assert page > 1e7, "the processes of the page were not found"
            memory = served.memory() + page
            faults = hurry(tab, _SEQUENCES, 3)
        with tempfile.TemporaryDirectory() as folder, Application(Path(folder)) as served:
            cut, serious = list[str](), list[str]()
            for width in WIDTHS:
                tab = Tab(browser, served.address, width)
                tab.settle()
                cut += [f"{width} px: {fault}" for fault in tab.cut_words()]
                serious += tab.inaccessible()
    finally:
        browser.close()
    load = f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, software WebGL"
    late = times[int(0.95 * len(times))]
    return [
        below(
            "change to picture, rigid, curves at a quarter of their points: median [ms]",
            statistics.median(times),
            100.0,
            COMMAND,
            load,
        ),
        below("the same, 95th percentile [ms]", late, 200.0, COMMAND, load),
        below("the same, two scenes: median [ms]", statistics.median(both), 100.0, COMMAND, load),
        below("start of the command to the first picture [s]", start, 4.0, COMMAND, load),
        below("words cut or overlapping at 1280, 1024 and 400 px", len(cut), 0, COMMAND, "; ".join(cut[:2])),
        below("serious violations that axe finds", len(serious), 0, COMMAND, "; ".join(serious[:2])),
        below("memory of server, worker and page [MB]", 1e-6 * memory, 500.0, COMMAND),
        below(
            f"sequences of {_SEQUENCES} that leave numbers of another scene", len(faults), 0, COMMAND, "; ".join(faults[:2])
        ),
        below(f"growth of the worker over {_CHANGES} changes [MB]", _growth(), 20.0, COMMAND),
    ]


def _growth() -> float:
    """Of server and worker, after the first tenth of the changes."""
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "kinematics": {"spin_speed_rpm": 9000.0}}
    session, finished, early = Session((as_given(scene),), Path()), threading.Event(), 0

    def hear(news: News) -> None:
        if news.kind == "done":
            finished.set()

    worker = Worker([], hear)
    try:
        for k in range(_CHANGES):
            if k == _CHANGES // 10:
                early = proportional_memory(os.getpid()) + proportional_memory(worker.process_id)
            session.change([0], "load.axial", f"{500 + k % 1000}")
            finished.clear()
            worker.submit(Job(session.number, {0: (session.number, session.scenes[0])}))
            finished.wait(60.0)
        return 1e-6 * (proportional_memory(os.getpid()) + proportional_memory(worker.process_id) - early)
    finally:
        worker.close()
