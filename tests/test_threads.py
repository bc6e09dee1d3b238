"""Threads that share work: how many, what they leave behind, and what becomes of a failure."""

import os
import threading

import pytest

from checks.validation.command_line import PATIENCE_S
from raceway.extend import ThreadPool, usable_cores


def helpers() -> int:
    """Threads of pools that live."""
    return sum(thread.name.startswith("raceway") for thread in threading.enumerate())


@pytest.mark.parametrize("count", [1, 2, 3])
def test_every_job_is_done_once_and_the_threads_end_with_the_pool(count):
    done = []
    with ThreadPool(count) as pool:
        for _ in range(50):
            pool.do(7, done.append)
        assert pool.do_shares(10, lambda first, last: last - first)[0] > 0
        assert sum(pool.do_shares(10, lambda first, last: last - first)) == 10
        with pool:  # inside again: the threads stay
            pool.do(3, done.append)
        pool.do(3, done.append)
        assert helpers() <= count - 1
    assert sorted(done) == sorted([*range(7)] * 50 + [*range(3)] * 2)
    assert helpers() == 0


def test_jobs_run_at_the_same_time_while_the_pool_is_open_and_one_by_one_after():
    meeting = threading.Barrier(3, timeout=PATIENCE_S)
    pool = ThreadPool(3)
    with pool:
        pool.do(3, lambda number: meeting.wait())  # three have to be there at once
    names = set()
    pool.do(3, lambda number: names.add(threading.current_thread()))
    assert names == {threading.current_thread()}


def test_a_failure_is_handed_on_when_nothing_runs_any_more():
    begun, running, tick = [], [], threading.Barrier(2, timeout=PATIENCE_S)

    def job(number: int) -> None:
        begun.append(number)
        if number < 2:
            tick.wait()  # both threads have one
        if number == 0:
            raise ValueError("no force")
        running.append(number)
        threading.Event().wait(0.05)
        running.remove(number)

    with pytest.raises(ValueError, match="no force"), ThreadPool(2) as pool:
        try:
            pool.do(1000, job)
        finally:
            assert running == []
    assert len(begun) < 10
    assert helpers() == 0


def test_threads_are_the_cores_of_the_process_and_no_more_than_the_environment_allows(monkeypatch):
    for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(range(6)), raising=False)
    assert usable_cores() == 6
    monkeypatch.setenv("OMP_NUM_THREADS", "4,2")
    assert usable_cores() == 4
    monkeypatch.setenv("NUMBA_NUM_THREADS", "3")
    assert usable_cores() == 3
    monkeypatch.setenv("NUMBA_NUM_THREADS", "64")
    assert usable_cores() == 4
    monkeypatch.setenv("OMP_NUM_THREADS", "many")
    assert usable_cores() == 6
