"""A sweep on a real dask scheduler with worker processes of their own, all on 127.0.0.1."""

import socket
import warnings

import attrs
import pytest

import raceway
from checks.validation.cluster import POINTS, START_S, Cluster, installed, prepared, rows
from checks.validation.command_line import invoke
from checks.validation.scenes import built_in
from raceway import PluginError
from raceway.points.sweep import fill_store

Dask = built_in("executor", "dask")
Serial = built_in("executor", "serial")


@pytest.fixture(scope="module", autouse=True)
def plugin(tmp_path_factory):
    with installed(tmp_path_factory.mktemp("site")) as folder:
        yield folder


@pytest.fixture(scope="module")
def cluster(tmp_path_factory, plugin):
    found = Cluster(tmp_path_factory.mktemp("cluster"), plugin)
    try:
        found.bare_worker("without")
        found.wait_for_workers(1)
        yield found
    finally:
        found.stop()


@pytest.mark.slow
def test_a_worker_killed_half_way_and_one_without_the_plugin_change_nothing(cluster, tmp_path):
    """Same bits as in one process: every worker runs its points with the same kernels."""
    cluster.worker("first")
    cluster.worker("second")
    cluster.wait_for_workers(3)
    alone = fill_store(prepared(tmp_path / "serial"), Serial())  # first, so that kernels are compiled once
    killed = []

    def kill_one(_what, done, total):
        if not killed and done >= total // 2:
            killed.append((cluster.kill_busy(), done))

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = fill_store(
            prepared(tmp_path / "dask"), Dask(scheduler=cluster.address, patience=START_S), on_progress=kill_one
        )
    with found, alone:
        ((name, done),) = killed
        assert name in ("first", "second")
        assert done < POINTS, "nothing was left for the other worker"
        assert found.status()["done"] == POINTS, next(found.rows())["reason"]
        assert rows(found) == rows(alone)
        pids = {int(cost["worker"].rpartition(":")[2]) for cost in found.costs(int)}
        assert pids <= {cluster.running[name].pid for name in ("first", "second")}
    refused = [str(one.message) for one in told if "gets no points" in str(one.message)]
    assert len(refused) == 1
    assert "contact law 'elsewhere' of law_elsewhere 1.0 is missing" in refused[0]


@pytest.mark.slow
def test_workers_of_another_version_are_refused_by_name(cluster, tmp_path):
    found = prepared(tmp_path / "store")
    wanted = {**found.facts["identity"], "raceway": "9.9"}
    with warnings.catch_warnings(), pytest.raises(PluginError) as told:
        warnings.simplefilter("ignore")
        fill_store(attrs.evolve(found, facts={**found.facts, "identity": wanted}), Dask(scheduler=cluster.address))
    assert "no dask worker can compute these points: tcp://127.0.0.1:" in str(told.value)
    assert f"raceway {raceway.__version__} instead of 9.9" in str(told.value)
    assert not (tmp_path / "store").exists()  # nothing was computed, and nothing stands in the way of another try


@pytest.mark.parametrize("listens", [True, False], ids=["silent", "nobody"])
def test_a_scheduler_that_does_not_answer(tmp_path, listens):
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{door.getsockname()[1]}"
        if listens:
            door.listen()
        with pytest.raises(PluginError) as told:
            fill_store(prepared(tmp_path / "store"), Dask(scheduler=address, patience=0.5))
    assert f"no dask scheduler answers at `{address}` within 0.5 s" in str(told.value)
    assert "dask scheduler" in str(told.value) and ": ." not in str(told.value)  # every failure has a word


def test_an_address_that_is_none(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n\n[load]\naxial = 1000.0\n')
    words = ("sweep", scene, "--grid", "load.axial=400,1000", "--executor", "dask", "--out", tmp_path / "store")
    found = invoke(*words, "--scheduler", "nowhere at all")
    assert found.exit_code == 2
    assert "no dask scheduler answers at `nowhere at all`" in found.stderr
