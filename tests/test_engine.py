"""The engine of studies: rows in order by any executor, kept, resumed; what takes its process down is not kept."""

import os
import sqlite3
from contextlib import closing

import pytest

from checks.validation.scenes import built_in
from raceway import RacewayError
from raceway.extend import Item, work_through, written
from raceway.testing import default_registry
from tests.deadly_work import deadly, squared

Processes = built_in("executor", "processes")
Serial = built_in("executor", "serial")

REGISTRY = default_registry()
ITEMS = [Item(f"key {number}", f"number {number}", number) for number in range(6)]


@pytest.mark.parametrize("executor", [Serial(), pytest.param(Processes(workers=2), marks=pytest.mark.slow)])
def test_rows_are_in_order_and_kept_ones_are_not_computed_again(executor, tmp_path):
    told = []
    with written(tmp_path) as store:
        found, reused = work_through(squared, ITEMS[::2], store, executor, REGISTRY, on_progress=lambda *w: told.append(w))
    assert [row["square"] for row in found] == [0, 4, 16] and reused == 0
    assert [words[1:] for words in told] == [(1, 3), (2, 3), (3, 3)]
    assert all((row["process"] == os.getpid()) == isinstance(executor, Serial) for row in found)
    with written(tmp_path) as store:
        again, reused = work_through(squared, ITEMS, store, executor, REGISTRY)
    assert [row["square"] for row in again] == [0, 1, 4, 9, 16, 25] and reused == 3
    assert again[::2] == found


def test_what_takes_its_process_down_is_told_and_tried_again_next_time(tmp_path):
    executor = Processes(workers=1)
    with (
        pytest.raises(RacewayError, match=r"number 3: its process died \(EXIT\(11\)\).*run the command again"),
        written(tmp_path) as store,
    ):
        work_through(deadly, ITEMS, store, executor, REGISTRY)
    with written(tmp_path) as store:
        kept = store.keys("done")
        assert kept and kept <= {item.key for item in ITEMS} - {"key 3"}
        rows, _ = work_through(deadly, ITEMS, store, executor, REGISTRY, lost=lambda _item, why: {"lost": why})
        assert "EXIT(11)" in rows[3]["lost"] and rows[5]["square"] == 25
        assert "key 3" not in store.keys("done")


def test_an_interruption_keeps_what_is_finished_and_leaves_no_process(tmp_path):
    def stop(_name, done, _total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), written(tmp_path) as store:
        work_through(squared, ITEMS, store, Processes(workers=1), REGISTRY, on_progress=stop)
    with written(tmp_path) as store:
        rows = [store.get(key).content for key in store.keys("done")]
    assert len(rows) == 2
    for row in rows:
        with pytest.raises(ProcessLookupError):
            os.kill(row["process"], 0)


def test_damaged_rows_of_a_study_are_computed_again(tmp_path):
    with written(tmp_path) as store:
        rows, _ = work_through(squared, ITEMS, store, Serial(), REGISTRY)
    with closing(sqlite3.connect(tmp_path / "points.sqlite")) as file, file:
        file.execute("UPDATE points SET content = replace(content, '16', '17') WHERE key = 'key 4'")
    with pytest.warns(UserWarning, match="1 rows of the store are damaged"), written(tmp_path) as store:
        assert work_through(squared, ITEMS, store, Serial(), REGISTRY) == (rows, 5)
    with written(tmp_path), pytest.raises(RacewayError, match="is being written by another process"), written(tmp_path):
        pass
