"""``raceway app`` in headless chromium: time from a change to its picture, start, memory, and numbers beside those of runs."""

import os
import statistics
import tempfile
from pathlib import Path

from checks.robustness import Row, below
from checks.validation.browser.application import Application, Tab, hurry
from checks.validation.browser.chromium import Browser

#: Changes of each kind, and sequences of changes without a look.
_CHANGES, _SEQUENCES = 20, 2


def rows() -> list[Row]:
    browser = Browser()
    try:
        with tempfile.TemporaryDirectory() as folder, Application(Path(folder)) as served:  # the two excitation models
            tab = Tab(browser, served.address)
            start, shown = served.elapsed(), {}
            for scenes in (2, 1):
                tab.settle()
                tab.drag("load.axial", 690, "done")
                before = served.memory()
                shown[scenes] = sorted(tab.drag("load.axial", 700 + 10 * k) for k in range(_CHANGES))
                growth = served.memory() - before
                tab.drag("load.axial", 1000, "done")
                if scenes == 2:
                    page = tab.memory()
                    assert page > 1e7, "the processes of the page were not found"
                    memory = served.memory() + page
                    tab.press("Compare two scenes")
            numbers = statistics.median(tab.drag("load.axial", 700 + 10 * k, "done") for k in range(5))
            faults = hurry(tab, _SEQUENCES, 3)
    finally:
        browser.close()
    load = f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, software WebGL"
    late = max(times[int(0.95 * len(times))] for times in shown.values())
    return [
        below("change to picture (K and curves), two scenes: median [ms]", statistics.median(shown[2]), 100.0, load),
        below("the same, one scene: median [ms]", statistics.median(shown[1]), 100.0, load),
        below("the same, 95th percentile of either [ms]", late, 200.0, load),
        below("change to all numbers of the run, one scene: median [ms]", numbers, 1000.0, load),
        below("start of the command to all numbers of two scenes [s]", start, 4.0, load),
        below("memory of server, worker and page [MB]", 1e-6 * memory, 500.0),
        below(f"growth of server and worker by {_CHANGES} changes [MB]", 1e-6 * growth, 20.0),
        below(f"sequences of {_SEQUENCES} that leave numbers of another scene", len(faults), 0, "; ".join(faults[:2])),
    ]
