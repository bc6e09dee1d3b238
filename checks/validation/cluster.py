"""A dask scheduler and worker processes on 127.0.0.1, as a user starts them, and a sweep with a plug-in to put on them."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

from checks.validation.command_line import found_on, install
from raceway.points import engine as work
from raceway.points.axes import grid
from raceway.points.dataset import SweepStore
from raceway.points.sweep import Sweep, prepare
from raceway.testing import b7206c

#: Some ten milliseconds a point here; on the workers it sleeps, so that they are killed at work.
POINTS = 24
SCENE = b7206c(
    title="on a cluster",
    rotor={"mass": 2.0},
    excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
    integrator={"kind": "quasi_static"},  # each point is a run
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
START_S = 300.0


class Cluster:
    """A scheduler and workers as a user starts them, without the nanny that would replace a dead one."""

    def __init__(self, folder: Path, plugin: Path) -> None:
        self.folder, self.plugin = folder, plugin
        self.running: dict[str, subprocess.Popen[bytes]] = {}
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

    def worker(self, name: str) -> None:
        """One that has the plug-in, whose points take a quarter of a second."""
        path = os.pathsep.join([str(self.plugin), os.environ.get("PYTHONPATH", "")])
        self.bare_worker(name, PYTHONPATH=path, LAW_TAKES="0.25", **found_on(path))

    def bare_worker(self, name: str, **environment: str) -> None:
        words = ("--no-nanny", "--nthreads", "1", "--name", name, "--local-directory", self.folder / name)
        self._start(name, "dask_worker", self.address, *words, **environment)

    def _wait(self, there):
        end = time.monotonic() + START_S
        while not there():
            assert time.monotonic() < end, [path.read_text() for path in self.folder.glob("*.log")]
            time.sleep(0.05)

    def wait_for_workers(self, count):
        from distributed import Client

        with Client(self.address, timeout=START_S) as client:
            client.wait_for_workers(count, timeout=START_S)

    def kill_busy(self):
        """Kill a worker that has points in flight; its name."""
        from distributed import Client

        with Client(self.address, timeout=START_S) as client:
            names = {address: worker["name"] for address, worker in client.scheduler_info(n_workers=-1)["workers"].items()}
            name = next(names[address] for address, tasks in client.processing().items() if tasks)
        self.running[name].send_signal(signal.SIGKILL)
        self.running[name].wait()
        return name

    def stop(self):
        for process in self.running.values():
            process.kill()
            process.wait()


@contextmanager
def installed(folder: Path) -> Iterator[Path]:
    """The plug-in, installed in a folder that this process looks into."""
    install(folder, "law_elsewhere", LAW)
    own, work._OWN = work._OWN, {}
    sys.path.insert(0, str(folder))
    try:
        with patch.dict(os.environ, found_on(folder)):
            yield folder
    finally:
        sys.path.remove(str(folder))
        work._OWN = own


def prepared(path: Path) -> Sweep:
    return prepare(SCENE, grid([f"excitation.speed_rpm=6000:15000:{POINTS}"]), path)


def rows(store: SweepStore) -> list[tuple[Any, str, Any]]:
    """What a sweep is for; no costs, no names of processes."""
    return [(row["point"], row["status"], row["values"]) for row in store.rows()]
