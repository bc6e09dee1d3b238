"""A sweep that was killed: points that were being computed are computed again."""

from __future__ import annotations

import sqlite3

from raceway.plugins.executors.serial import Serial
from raceway.studies.sweep import grid, open_store, prepare, sweep
from raceway.studies.sweep.store import POINTS

TABLES = {"title": "test", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
DESIGN = grid(["load.axial=400:1000:4"])


def test_points_left_running_by_a_kill_are_computed_on_resume(tmp_path):
    store = tmp_path / "store"
    sweep(prepare(TABLES, DESIGN, store), Serial()).close()
    with open_store(store) as there:
        whole = [(row["status"], row["values"]) for row in there.rows()]
    # What SIGKILL leaves: nothing puts the state back.
    with sqlite3.connect(store / POINTS) as connection:
        connection.execute("UPDATE points SET state = 'running', content = NULL WHERE number IN (1, 3)")
    sweep(prepare(TABLES, DESIGN, store, resume=True), Serial()).close()
    with open_store(store) as there:
        assert there.status()["done"] == DESIGN.size
        assert [(row["status"], row["values"]) for row in there.rows()] == whole
