"""Sweeps on a dask scheduler with two worker processes, one of which is killed at a random moment."""

from __future__ import annotations

import random
import socket
import tempfile
import time
import warnings
from pathlib import Path

import attrs

from checks.robustness import Row, below
from checks.validation.cluster import POINTS, START_S, Cluster, installed, prepared
from checks.validation.cluster import rows as rows_of
from checks.validation.scenes import built_in
from raceway import PluginError
from raceway.points.sweep import fill_store

Dask = built_in("executor", "dask")
Serial = built_in("executor", "serial")

TITLE = "Sweeps on a dask scheduler: killed, unfit and silent partners"
COMMAND = "python -m checks dask"
TEST = "python -m pytest tests/test_dask.py"
_KILLS, _SEED, _PATIENCE_S = 20, 20, 2.0


def rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name in ("site", "cluster"):
            (folder / name).mkdir()
        with installed(folder / "site") as plugin:
            cluster = Cluster(folder / "cluster", plugin)
            try:
                return [*_kills(cluster, folder), *_unfit(cluster, folder), _silent(folder)]
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


def _unfit(cluster: Cluster, folder: Path) -> list[Row]:
    """A worker without the plug-in, then workers of another version."""
    cluster.bare_worker("without")
    cluster.wait_for_workers(3)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        with fill_store(prepared(folder / "unfit"), Dask(scheduler=cluster.address, patience=START_S)) as store:
            done = store.status()["done"]
            pids = {int(cost["worker"].rpartition(":")[2]) for cost in store.costs(int)}
    words = [str(one.message) for one in told if "elsewhere" in str(one.message)]
    refused = bool(words) and cluster.running["without"].pid not in pids and done == POINTS
    said = words[0].partition(" gets ")[2] if words else "nothing is said"
    found = prepared(folder / "version")
    wanted = {**found.facts["identity"], "raceway": "9.9"}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fill_store(attrs.evolve(found, facts={**found.facts, "identity": wanted}), Dask(scheduler=cluster.address))
        version = "computed all the same"
    except PluginError as error:
        version = str(error).partition(": tcp")[0] + ": " + str(error).rpartition(": ")[2]
    return [
        Row(
            "a worker without the plug-in, beside two that have it",
            f"gets {said}",
            "named, and gets no points",
            refused,
            TEST,
        ),
        Row(
            "all workers of another version",
            version.split(";")[0],
            "named, nothing is computed",
            "instead of 9.9" in version,
            TEST,
        ),
    ]


def _silent(folder: Path) -> Row:
    """A port that is open and never says anything."""
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        door.listen()
        start = time.monotonic()
        try:
            fill_store(
                prepared(folder / "silent"), Dask(scheduler=f"tcp://127.0.0.1:{door.getsockname()[1]}", patience=_PATIENCE_S)
            )
        except PluginError:
            waited = time.monotonic() - start
        else:
            waited = float("inf")
    return below(
        f"seconds until a scheduler that does not answer is given up, patience {_PATIENCE_S:g} s", waited, _PATIENCE_S + 5.0, TEST,
        "the bound leaves room for a busy machine",
    )  # fmt: skip
