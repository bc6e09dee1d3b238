"""Millions of points: processor time of a point in the compiled loops, and the same numbers by runs of their own."""

import resource
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import raceway as rw
from checks.kernel import least
from checks.robustness import Row, below
from checks.validation.columns import compare

_MANY, _BLOCK = 10**7, 100_000
#: Of a worker: pages of a block's arrays stay with the process, see docs/points.md.
_MEMORY = {"MALLOC_MMAP_THRESHOLD_": 2**25, "MALLOC_TRIM_THRESHOLD_": 2**28}
STATIC: dict[str, Any] = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1.0, "radial": [0.0, 0.0]}, "supports": {"tilt": "free"},
    "kinematics": {"spin_speed_rpm": 12000.0},
}  # fmt: skip
PAIR = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "row_distance": 0.016}
_SET = STATIC | {"bearing": PAIR}


def turning(kind: str, damping: float = 0.0) -> dict[str, Any]:
    force = {"kind": kind, "speed_rpm": 9000.0, "unbalance": 1e-5}
    return STATIC | {
        "rotor": {"mass": 1.0}, "kinematics": {}, "contact": {"damping": damping}, "excitation": force,
        "integrator": {"kind": "periodic"},
    }  # fmt: skip


def _on_top(output: str) -> float:
    """Processor time of a plug-in's number over that of 1e5 equilibria with an oil, per cent; least of five of each, in turns."""
    scene = STATIC | {"lubricant": {"oil": "VG 32", "temperature_c": 60.0}}
    ranges = {"load.axial": (300.0, 2000.0), "load.radial[0]": (0.0, 200.0), "kinematics.spin_speed_rpm": (1000.0, 24_000.0)}
    pairs = [[seconds(scene, ["stiffness", *more], ranges, 10**5) for more in ([], [output])] for _ in range(5)]
    alone, both = np.min(pairs, axis=0)
    return float(100.0 * (both / alone - 1.0))


def _warm_over_cold() -> float:
    """Processor time of a point with [heat] over that of one at these temperatures, in a batch."""
    pair = {**STATIC, "bearing": {**PAIR, "preload": 300.0}, "load": {}, "supports": {}, "lubricant": {"oil": "VG 32"}}
    warm = pair | {"heat": {"oil_inlet_c": 40.0, "oil_flow": 8e-6}}
    cold = pair | {"lubricant": {"oil": "VG 32", "temperature_c": 60.0}, "mounting": {"inner_temperature": 30.0}}
    ranges = {"kinematics.spin_speed_rpm": (1000.0, 14_000.0)}
    pairs = [[seconds(scene, ["kyy"], ranges, 2 * 10**4) for scene in (warm, cold)] for _ in range(3)]
    heated, alone = np.min(pairs, axis=0)
    return float(heated / alone)


def seconds(scene: dict[str, Any], outputs: list[str], ranges: dict[str, tuple[float, float]], n: int) -> float:
    """Processor time [s] of n random points, kernels compiled."""
    rng, f = np.random.default_rng(1), rw.function(scene, ranges, outputs, threads=1)
    columns = [rng.uniform(*ends, size=n) for ends in ranges.values()]
    f(*(column[:20] for column in columns))
    begun = time.process_time()
    answer = f(*columns)
    spent = time.process_time() - begun
    assert (answer["status"] == rw.PointStatus.COMPUTED).mean() > 0.99, "the loop computes the points"
    return spent


def _milliseconds(call: Callable[[], object]) -> float:
    return 1e3 * least(call, 7, time.process_time)


def _by_dask(point: float) -> list[Row]:
    """1e7 points in blocks on a local cluster of two processes, against ``point`` seconds each in one process."""
    import dask
    import dask.array as da
    from distributed import Client, LocalCluster

    ranges = {"load.axial": (300.0, 2000.0), "kinematics.spin_speed_rpm": (1000.0, 24_000.0)}
    f, rng = rw.function(STATIC, ranges, ["kyy"], threads=1), da.random.default_rng(1)
    columns = [rng.uniform(*ends, size=_MANY, chunks=_BLOCK) for ends in ranges.values()]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    dask.config.set({f"distributed.nanny.pre-spawn-environ.{name}": size for name, size in _MEMORY.items()})
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster):
        stiffness = da.map_blocks(f.arrays, *columns, dtype=float)
        count, mean = da.compute(stiffness.size, stiffness.mean())
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert count == _MANY and 1e7 < mean < 1e9, "a mean stiffness of all points"
    share = round(cpu / (_MANY * point), 3)
    return [
        below("1e7 points by dask on two processes: processor time over that of one process", share, 1.1),
        below("memory of a worker [GB]", round(1024e-9 * after.ru_maxrss, 3), 2.0),
    ]


def rows() -> list[Row]:
    loads = {"load.axial": (300.0, 2000.0), "load.radial[0]": (0.0, 200.0), "kinematics.spin_speed_rpm": (1000.0, 24_000.0)}
    geometry = {
        "bearing.contact_angle_deg": (12.0, 30.0), "bearing.conformity_inner": (0.51, 0.54), "bearing.conformity_outer": (0.51, 0.54),
        "bearing.preload": (100.0, 900.0), "load.axial": (0.0, 300.0),
    }  # fmt: skip
    motion = {"load.axial": (600.0, 2000.0), "excitation.speed_rpm": (3000.0, 15_000.0)}
    compared = compare(range(1000, 1100))
    note = f"{compared.status['COMPUTED']} of {compared.status.total()} points in the loop; displacements {compared.moved:.1e}; {compared.seconds:.0f} CPU-s"
    equality = "largest difference from runs, bearings, sets, laws, tilts, growth, moments"
    out = [below(equality, float(f"{compared.worst:.1e}"), 1e-9, note)]
    f, hundred = rw.function(STATIC, ["load.axial"], ["kyy"], threads=1), np.linspace(300.0, 2000.0, 100)
    single, orbit = (scene | {"load": {"axial": 1000.0}} for scene in (STATIC, turning("bidirectional")))
    cases: list[tuple[str, Callable[[], float], float]] = [
        ("1e6 equilibria with 5 x 5 over load and speed [CPU-s]", lambda: seconds(STATIC, ["displacement", "stiffness"], loads, 10**6), 4.0),
        ("1e5 equilibria of a DB pair over its geometry and preload [CPU-s]", lambda: seconds(_SET, ["stiffness"], geometry, 10**5), 10.0),
        ("1e5 steady orbits, rotating force [CPU-s]", lambda: seconds(turning("bidirectional"), ["K", "C"], motion, 10**5), 2.5),
        ("the same with dashpots at the contacts [CPU-s]", lambda: seconds(turning("bidirectional", 1e-3), ["K", "C"], motion, 10**5), 25.0),
        ("an orbit under a one-directional force, tilt free [CPU-ms]", lambda: seconds(turning("unidirectional"), ["K"], motion, 10**4) / 10, 1.0),
        ("life of 1e5 points on top of their equilibria [%]", lambda: _on_top("l10r_hours"), 20.0),
        ("friction torque of 1e5 points on top of their equilibria [%]", lambda: _on_top("torque_nm"), 20.0),
        ("a warm point over a cold one in a batch", _warm_over_cold, 8.0),
        ("rw.function of one point [CPU-ms]", lambda: _milliseconds(lambda: f(1000.0)), 0.3),
        ("rw.function of 100 points [CPU-ms]", lambda: _milliseconds(lambda: f(hundred)), 1.0),
        ("rw.run, static [CPU-ms]", lambda: _milliseconds(lambda: rw.run(single)), 2.0),
        ("rw.run, steady orbit [CPU-ms]", lambda: _milliseconds(lambda: rw.run(orbit)), 5.0),
    ]  # fmt: skip
    out += [below(quantity, round(measure(), 3), bound) for quantity, measure, bound in cases]
    two_columns = {key: loads[key] for key in ("load.axial", "kinematics.spin_speed_rpm")}
    return out + _by_dask(seconds(STATIC, ["kyy"], two_columns, 10**6) / 10**6)
