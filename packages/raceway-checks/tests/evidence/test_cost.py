"""Cost of runs, sweeps and caches.

Times are least processor times of repeats by turns, ratios inside one process: other programs on the machine meet both.
"""

import json
import time
from functools import cache

import pytest
from raceway_checks.precision.answer import EXACT

import raceway as rw
from checks.validation import plan_time
from checks.validation.command_line import ARTICLE, MINIMAL, python, raceway
from raceway import load_scene, precision
from raceway.extend import read_toml
from raceway.planning.plan import column_time

pytestmark = pytest.mark.night


@cache
def studied():
    """Reference and rows of the scene's own model, by the default design of `raceway precision`."""
    content = precision(read_toml(ARTICLE), repeats=5).to_dict()
    return content["reference"], [row for row in content["rows"] if row["base"] and row["error"] is not None]


def apart(row, reference) -> float:
    own = complex(row["quantities"]["z_real"], row["quantities"]["z_imag"])
    known = complex(*(reference["quantities"][name]["value"] for name in ("z_real", "z_imag")))
    return abs(own - known) / abs(known)


def test_reference(claim):
    reference, rows = studied()
    best = min(row["error"] for row in rows if row["family"] != "steady orbit")
    quantity = "bound of the reference over the error of the best transient row, the article's scene"
    source = "Newmark and central differences"
    claim(quantity, reference["error"] / best, at_most=1.0 / EXACT, basis="own other method", source=source)
    wrong = sum((apart(row, reference) <= EXACT * reference["error"]) != row["at_bound"] for row in rows)
    quantity = "rows marked as known to the bound only, though they are not, or the other way round"
    claim(quantity, wrong, at_most=0, basis="closed form", source=f"those within ten bounds, of {len(rows)}")


@pytest.mark.parametrize(("error", "limit"), [(0.01, 50.0), (0.0001, 1000.0)])
def test_time_for_an_error(claim, error, limit):
    reference, rows = studied()
    good = [row for row in rows if row["errors"]["equivalent_stiffness"] + reference["error"] <= error]
    fastest = 1e3 * min(row["cost"]["solve_s"] for row in good)
    quantity, source = (
        f"solve time for K within {100.0 * error:g} %",
        "a study of a hundred points in some seconds, or two minutes",
    )
    claim(quantity, fastest, at_most=limit, unit="ms", basis="regression", source=source)


def test_a_run_with_warm_caches(claim, tmp_path):
    spent = []
    for _ in range(6):
        begin = time.perf_counter()
        assert raceway("run", ARTICLE, "--out", tmp_path).returncode == 0
        spent.append(time.perf_counter() - begin)
    quantity = "`raceway run examples/b7206.toml`, warm caches, least of five: wall time"
    claim(quantity, min(spent[1:]), at_most=2.0, unit="s", basis="regression", source="while one waits")


COUNT = """
import json, sys
from raceway import load_scene
from raceway.core.jit import clock
from raceway.core.ring.equilibrium import solve_equilibrium
from raceway.core.time.compiled import central_difference
from raceway.core.time.compiled import implicit
from raceway.core.time.compiled import quasi_static
from raceway.pipeline.run import run
run(load_scene(sys.argv[1]))
first = clock["compiled"]
for word in sys.argv[2:]:
    run(load_scene(sys.argv[1], [word]))
loops = (implicit, central_difference, quasi_static(solve_equilibrium))
print(json.dumps([first, clock["compiled"], sum(max(len(loop.signatures) - 1, 0) for loop in loops)]))
"""
WORDS = (
    "contact.kind=penalty", "excitation.kind=unidirectional", "integrator.kind=generalized_alpha", "integrator.kind=central_difference",
    "integrator.kind=quasi_static", "identifier.kind=sine_fit", "identifier.kind=order_tracking", "identifier.kind=tangent",
)  # fmt: skip


def test_kernels(claim, tmp_path):
    """Two processes with a cache of their own: the scene, then eight plug-ins swapped by one word."""
    found = []
    for _ in range(2):
        done = python("-c", COUNT, ARTICLE, *WORDS, RACEWAY_CACHE_DIR=tmp_path)
        assert done.returncode == 0, done.stderr
        files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()}
        found.append((json.loads(done.stdout), files))
    (first, before), (second, after) = found
    assert first[0] > 0 and before
    source = "compiled once for a machine"
    where = f"second process, the article's scene and {len(WORDS)} plug-ins swapped by one word"
    claim(f"{where}: kernels that it compiles", second[1], at_most=0, basis="closed form", source=source)
    changed = sum(before.get(path) != stamp for path, stamp in after.items())
    claim(
        f"{where}: cache files that it adds or rewrites", changed, at_most=0, basis="closed form", source=f"of {len(before)}"
    )
    source = "a loop takes addresses: one signature for every combination"
    quantity = f"{where}: signatures that the time loops gain"
    claim(quantity, max(first[2], second[2]), at_most=0, basis="closed form", source=source)


def test_predicted_time(claim):
    times = {name: plan_time.compare(changes) for name, changes in plan_time.SCENES.items()}
    beyond = [name for name, one in times.items() if not one.holds]
    ratio = max((one.ratio for one in times.values()), key=lambda ratio: max(ratio, 1.0 / ratio))
    quantity = f"predicted over measured processor time of runs, {len(times)} scenes, furthest from 1"
    source = f"a factor of 2; beyond it: {', '.join(beyond) or 'none'}"
    misses = "how long the search for further steady orbits takes is not known before"
    assert set(beyond) <= {"rigid, periodic, internal resonance"}, times
    limits = {"at_least": plan_time.LEAST, "at_most": plan_time.MOST}
    claim(quantity, ratio, **limits, basis="regression", source=source, misses=misses, machine=True)


def test_predicted_time_of_points(claim):
    scene, loads = load_scene(MINIMAL), [400.0 + k for k in range(1000)]
    points = rw.function(scene, ["load.axial"], ["K"], threads=1)
    points(loads[:5])
    begun = time.process_time()
    points(loads)
    ratio = 1000 * column_time(rw.make_plan(scene), moving=True) / (time.process_time() - begun)
    quantity = "predicted over measured processor time of a function of 1000 points that a motion is computed at"
    source = "a factor of 3: other programs on the machine and its caches change times by one of 2"
    claim(quantity, ratio, at_least=1.0 / 3.0, at_most=3.0, basis="regression", source=source, machine=True)


def test_planning(claim):
    mesh = ("mesh.kind=structured", "mesh.element_size=3.2e-3", "mesh.nodes_per_semi_axis=1", "mesh.growth=3.0")
    elastic = ("bodies.kind=elastic", "contact.discretisation=nodal", *mesh)
    times = []
    for _ in range(5):
        begun = time.process_time()
        rw.make_plan(load_scene(ARTICLE, elastic))
        times.append(time.process_time() - begun)
    quantity = "processor time of planning, the kind of bodies that takes longest"
    claim(quantity, 1e3 * min(times), at_most=20.0, unit="ms", basis="regression", source="a hundredth of a run")
