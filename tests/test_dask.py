"""A sweep on a real dask scheduler with worker processes of their own, all on 127.0.0.1."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
import warnings

import attrs
import pytest

from raceway.errors import PluginError
from raceway.plugins.executors.dask import Dask
from raceway.plugins.executors.serial import Serial
from raceway.studies.sweep import grid, prepare, sweep, work
from tests.command_line import install, invoke
from tests.conftest import b7206c

#: Of the steady orbit: some ten milliseconds a point here; on the workers it sleeps, so that they are killed at work.
POINTS = 24
SCENE = b7206c(
    title="on a cluster",
    rotor={"mass": 2.0},
    excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
    integrator={"kind": "periodic"},
    contact={"kind": "elsewhere"},
)
#: An installed plug-in, which not every machine has.
LAW = """
import os
import time

import attrs
from raceway import hookimpl
from raceway.contact_laws.hertz import Hertz

@attrs.frozen
class Elsewhere(Hertz):
    name = "elsewhere"

    def build(self, pairs):
        time.sleep(float(os.environ.get("LAW_TAKES", "0")))
        return super().build(pairs)

@hookimpl
def raceway_contact_laws():
    return [Elsewhere]
"""
_START_S = 90.0


class Cluster:
    """A scheduler and workers as a user starts them, without the nanny that would replace a dead one."""

    def __init__(self, folder):
        self.folder, self.running = folder, {}
        self.file = folder / "scheduler.json"
        self._start("scheduler", "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", self.file)
        self._wait(self._address)
        self.address = self._address()

    def _address(self):
        try:
            return json.loads(self.file.read_text())["address"]
        except (OSError, ValueError, KeyError):
            return None

    def _start(self, name, module, *words, **environment):
        command = [sys.executable, "-m", f"distributed.cli.{module}", "--no-dashboard", *map(str, words)]
        log = (self.folder / f"{name}.log").open("w")
        variables = {**os.environ, **environment}
        self.running[name] = subprocess.Popen(command, stdout=log, stderr=log, env=variables, cwd=self.folder)

    def worker(self, name, **environment):
        words = ("--no-nanny", "--nthreads", "1", "--name", name, "--local-directory", self.folder / name)
        self._start(name, "dask_worker", self.address, *words, **environment)

    def _wait(self, there):
        end = time.monotonic() + _START_S
        while not there():
            assert time.monotonic() < end, [path.read_text() for path in self.folder.glob("*.log")]
            time.sleep(0.05)

    def wait_for_workers(self, count):
        from distributed import Client

        with Client(self.address, timeout=_START_S) as client:
            client.wait_for_workers(count, timeout=_START_S)

    def kill_busy(self):
        """Kill a worker that has points in flight; its name."""
        from distributed import Client

        with Client(self.address, timeout=_START_S) as client:
            names = {address: worker["name"] for address, worker in client.scheduler_info(n_workers=-1)["workers"].items()}
            name = next(names[address] for address, tasks in client.processing().items() if tasks)
        self.running[name].send_signal(signal.SIGKILL)
        self.running[name].wait()
        return name

    def stop(self):
        for process in self.running.values():
            process.kill()
            process.wait()


@pytest.fixture(scope="module", autouse=True)
def plugin(tmp_path_factory):
    """The folder of the plug-in, installed for this process and for those whose path has the folder."""
    folder = install(tmp_path_factory.mktemp("site"), "law_elsewhere", LAW)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        patch.setattr(work, "_OWN", {})
        yield folder


@pytest.fixture(scope="module")
def cluster(tmp_path_factory, plugin):
    found = Cluster(tmp_path_factory.mktemp("cluster"))
    path = os.pathsep.join([str(plugin), os.environ.get("PYTHONPATH", "")])
    try:
        for name in ("first", "second"):
            found.worker(name, PYTHONPATH=path, LAW_TAKES="0.25")
        found.worker("without")
        found.wait_for_workers(3)
        yield found
    finally:
        found.stop()


def prepared(path):
    return prepare(SCENE, grid([f"excitation.speed_rpm=6000:15000:{POINTS}"]), path)


def rows(store):
    """What a sweep is for; no costs, no names of processes."""
    return [(row["point"], row["status"], row["values"]) for row in store.rows()]


def test_a_worker_killed_half_way_and_one_without_the_plugin_change_nothing(cluster, tmp_path):
    """Same bits as in one process: every worker runs the same chains of points with the same kernels."""
    alone = sweep(prepared(tmp_path / "serial"), Serial())  # first, so that kernels are compiled once
    killed = []

    def kill_one(_what, done, total):
        if not killed and done >= total // 2:
            killed.append((cluster.kill_busy(), done))

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = sweep(prepared(tmp_path / "dask"), Dask(scheduler=cluster.address, patience=_START_S), on_progress=kill_one)
    with found, alone:
        ((name, done),) = killed
        assert name in ("first", "second")
        assert done < POINTS, "nothing was left for the other worker"
        assert found.status()["done"] == POINTS, next(found.rows())["reason"]
        assert rows(found) == rows(alone)
        pids = {int(row["cost"]["worker"].rpartition(":")[2]) for row in found.rows()}
        assert pids <= {cluster.running[name].pid for name in ("first", "second")}
    refused = [str(one.message) for one in told if "gets no points" in str(one.message)]
    assert len(refused) == 1
    assert "contact law 'elsewhere' of law_elsewhere 1.0 is missing" in refused[0]


def test_workers_of_another_version_are_refused_by_name(cluster, tmp_path):
    found = prepared(tmp_path / "store")
    wanted = {**found.facts["identity"], "raceway": "9.9"}
    with warnings.catch_warnings(), pytest.raises(PluginError) as told:
        warnings.simplefilter("ignore")
        sweep(attrs.evolve(found, facts={**found.facts, "identity": wanted}), Dask(scheduler=cluster.address))
    assert "no dask worker can compute these points: tcp://127.0.0.1:" in str(told.value)
    assert "raceway 0.1.0 instead of 9.9" in str(told.value)
    assert not (tmp_path / "store").exists()  # nothing was computed, and nothing stands in the way of another try


@pytest.mark.parametrize("listens", [True, False], ids=["silent", "nobody"])
def test_a_scheduler_that_does_not_answer(tmp_path, listens):
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{door.getsockname()[1]}"
        if listens:
            door.listen()
        start = time.monotonic()
        with pytest.raises(PluginError) as told:
            sweep(prepared(tmp_path / "store"), Dask(scheduler=address, patience=1.0))
    assert time.monotonic() - start < 30.0  # a bound on a busy machine; the patience is 1 s
    assert f"no dask scheduler answers at `{address}` within 1 s" in str(told.value)
    assert "dask scheduler" in str(told.value)


def test_an_address_that_is_none(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n\n[load]\naxial = 1000.0\n')
    words = ("sweep", scene, "--grid", "load.axial=400,1000", "--executor", "dask", "--out", tmp_path / "store")
    found = invoke(*words, "--scheduler", "nowhere at all")
    assert found.exit_code == 2
    assert "no dask scheduler answers at `nowhere at all`" in found.stderr
