"""Sweeps on a dask scheduler with two worker processes, one of which is killed at a random moment."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path

from checks.robustness import Row
from checks.validation.cluster import POINTS, START_S, Cluster, installed, prepared
from checks.validation.cluster import rows as rows_of
from checks.validation.scenes import built_in
from raceway.points.sweep import fill_store

Dask = built_in("executor", "dask")
Serial = built_in("executor", "serial")

COMMAND = "python -m checks dask"
_KILLS, _SEED = 20, 20


def rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name in ("site", "cluster"):
            (folder / name).mkdir()
        with installed(folder / "site") as plugin:
            cluster = Cluster(folder / "cluster", plugin)
            try:
                return _kills(cluster, folder)
            finally:
                cluster.stop()


def _kills(cluster: Cluster, folder: Path) -> list[Row]:
    """A worker with points in flight is killed after a random number of points; another one takes its place."""
    with fill_store(prepared(folder / "serial"), Serial()) as alone:
        wanted = rows_of(alone)
    chance = random.Random(_SEED)
    cluster.worker("worker-0")
    cluster.worker("worker-1")
    equal = complete = 0
    moments = []
    for k in range(_KILLS):
        cluster.wait_for_workers(2)
        moment, killed = chance.randint(1, POINTS * 2 // 3), list[str]()

        def kill(_what: str, done: int, _total: int, k: int = k, moment: int = moment, killed: list[str] = killed) -> None:
            if not killed and done >= moment:
                killed.append(cluster.kill_busy())
                moments.append(done)
                cluster.worker(f"worker-{k + 2}")

        with fill_store(
            prepared(folder / f"sweep-{k}"), Dask(scheduler=cluster.address, patience=START_S), on_progress=kill
        ) as store:
            complete += store.status()["done"] == POINTS
            equal += rows_of(store) == wanted
    told = f"{POINTS} points each; killed after {min(moments)} to {max(moments)} of them"
    return [
        Row(
            f"sweeps of {_KILLS} that finish with one of two workers killed",
            complete,
            f"{_KILLS}",
            complete == _KILLS,
            COMMAND,
            told,
        ),
        Row("of these, sweeps with the bits of one in a single process", equal, f"{_KILLS}", equal == _KILLS, COMMAND),
    ]
