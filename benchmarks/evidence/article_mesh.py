"""The article's own model at rest: a million hexahedra in contact, beside condensed bodies, other solvers and the plan.  Half an hour."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from benchmarks.evidence._files import ROOT
from benchmarks.evidence._kept import kept
from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.system import ElasticSystem
from raceway.storage.cache_folder import cache_root

TITLE = "The article's mesh at rest"
COMMAND = "python -m benchmarks.evidence article_mesh"
SCENE = "examples/b7206_article_mesh.toml"
#: A bearing of 63 120 elements, and the same size in CalculiX, with facets [CPU s], measured before this program existed.
COARSE, CALCULIX_BEARING = "benchmarks/b7206_elastic_60k.toml", 334.0
RUN = f"raceway run {SCENE}"
ELEMENTS = 1_061_016
#: The article's four load cases: changes of the scene.
CASES = {
    "1000 N": {},
    "400 N": {"load.axial": "400"},
    "2000 N": {"load.axial": "2000"},
    "1000 N, 500 N radial": {"load.radial": "[500.0, 0.0]"},
}
#: The article's figure for its peak pressures against Hertz's.
PRESSURE = 0.0242
#: The same bearing condensed.
CONDENSED = {"bodies.kind": "condensed", "mesh": None, "contact.kind": "hertz", "contact.discretisation": "resultant"}
#: Smaller meshes for the plan: changes, and what they are called.
SIZES = {
    "elements of 1.6 mm, 2 nodes to the semi-axis": {"mesh.element_size": "1.6e-3", "mesh.nodes_per_semi_axis": "2"},
    "elements of 1.0 mm": {"mesh.element_size": "1.0e-3"},
}
#: Three balls, for the solvers' difference.
TINY = {
    "bearing.ball_count": "3", "load.axial": "240", "load.radial": "[100.0, 50.0]", "mesh.element_size": "3.2e-3",
    "mesh.azimuth_cells": "24", "mesh.nodes_per_semi_axis": "1", "mesh.ball_load": "300",
}  # fmt: skip
GIB = 2.0**30


def rows() -> list[Row]:
    return kept("article_mesh", [_statics, _condensed, _reduced, _plan, _former, _formulations])


def typed(changes: dict[str, str | None]) -> str:
    """The command of a run."""
    return " ".join([RUN, *(f"--set '{key}={value}'" for key, value in changes.items() if value is not None)])


@cache
def store() -> Path:
    """A folder for what runs keep, of this process: it begins with this machine's compiled kernels and nothing else."""
    folder = Path(tempfile.mkdtemp(prefix="article-mesh-"))
    kernels = cache_root() / "kernels"
    if kernels.is_dir():
        shutil.copytree(kernels, folder / "kernels")
    return folder


def measured(changes: dict[str, str | None], folder: Path | None = None) -> dict[str, Any]:
    """``result.json`` of a run as a process, with its ``cpu_s`` and ``peak_bytes``, kernels being compiled."""
    with tempfile.TemporaryDirectory() as out:
        # Without a mesh table: a scene file of its own.
        words = [str(word) for key, value in changes.items() if value is not None for word in ("--set", f"{key}={value}")]
        scene = _without_mesh(Path(out)) if changes.get("mesh", "") is None else ROOT / SCENE
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "RACEWAY_CACHE_DIR": str(folder or store())}
        command = [sys.executable, "-m", "raceway", "run", str(scene), *words, "--out", out, "--json"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment, text=True)
        assert process.stderr is not None
        said = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise RuntimeError(f"{typed(changes)} ended with {process.returncode}: {said[-2000:]}")
        result: dict[str, Any] = json.loads((Path(out) / "result.json").read_text())
    return result | {"cpu_s": used.ru_utime + used.ru_stime, "peak_bytes": 1024 * used.ru_maxrss}


def _without_mesh(folder: Path) -> Path:
    path, skipping = folder / "scene.toml", False
    lines = []
    for line in (ROOT / SCENE).read_text().splitlines():
        skipping = line.startswith("[mesh]") or (skipping and not line.startswith("["))
        lines += [] if skipping else [line]
    path.write_text("\n".join(lines))
    return path


def compiled(also: dict[str, str | None]) -> None:
    """A small mesh with everything that the large one needs: its kernels are in the store afterwards."""
    coarse: dict[str, str | None] = {"mesh.element_size": "3e-3", "mesh.nodes_per_semi_axis": "1"}
    measured(coarse | also)


@cache
def static(case: str) -> dict[str, Any]:
    """A load case; the first of a process is from nothing, the others from what it kept."""
    compiled({}) if case == "1000 N" else static("1000 N")
    return measured(dict(CASES[case]))


def _statics() -> list[Row]:
    found = static("1000 N")
    cells, cpu, memory = found["model"]["mesh"]["cells"], found["cpu_s"], found["peak_bytes"] / GIB
    out = [
        Row("elements", cells, f"{ELEMENTS} within 1 %", abs(cells / ELEMENTS - 1.0) < 0.01, RUN),
        below("static: memory at the peak [GiB]", memory, 8.0, RUN),
        below(
            "static: equilibrium and 5 x 5 stiffness from nothing, CPU-s", cpu, 600.0, RUN,
            f"one thread, imports and stresses below the contacts included; compiling apart ({found['cost']['compile_s']:.1f} s)",
        ),
        _meshing(),
    ]  # fmt: skip
    for case, changes in list(CASES.items())[1:]:
        other, command = static(case), typed(dict(changes))
        note = f"a process of its own, superelements from the disk, memory {other['peak_bytes'] / GIB:.1f} GiB"
        out.append(below(f"{case}: another load, from the disk, CPU-s", other["cpu_s"], 20.0, command, note))
    for case in CASES:
        out += _pressures(case)
    return out + _shear(found)


def _meshing() -> Row:
    from raceway import load_scene
    from raceway.bodies.meshing import mesh_scene

    begin = time.process_time()
    mesh_scene(load_scene(ROOT / SCENE))
    return below("of which meshing, CPU-s", time.process_time() - begin, 20.0, f"raceway mesh {SCENE}")


def _pressures(case: str) -> list[Row]:
    balls, out = static(case)["equilibrium"]["balls"], []
    for race in ("inner", "outer"):
        load, hertz, own = (
            np.array([ball[name.format(race)] for ball in balls])
            for name in ("load_{}_n", "peak_pressure_{}_pa", "peak_pressure_nodal_{}_pa")
        )
        carries = load > 0.05 * load.max()
        error = own[carries] / hertz[carries] - 1.0
        worst, heaviest = float(error[np.argmax(np.abs(error))]), float(error[np.argmax(load[carries])])
        note = f"worst of {carries.sum()} loaded balls {worst:+.2%}; {load.max():.0f} N"
        ok = abs(heaviest) <= PRESSURE
        out.append(
            Row(
                f"{case}, {race} race: peak pressure of the most loaded ball over Hertz's at its load, less 1",
                f"{heaviest:+.2%}", f"within {PRESSURE:.2%}", ok, typed(dict(CASES[case])), note,
            )
        )  # fmt: skip
    return out


def _shear(found: dict[str, Any]) -> list[Row]:
    out = []
    for one in found["model"]["subsurface"]:
        size = one["largest_shear_pa"] / one["hertz_largest_shear_pa"] - 1.0
        depth = one["depth_m"] / one["hertz_depth_m"] - 1.0
        where = f"1000 N, {one['body']} at the {one['race']} race: largest shear stress and its depth over Hertz's, less 1"
        note = f"{one['cells_to_hertz_depth']:.1f} elements down to it"
        ok = max(abs(size), abs(depth)) <= 0.05 or not one["resolved"]
        limit = "within 5 %" if one["resolved"] else "within 5 % where the mesh resolves it: it does not"
        out.append(Row(where, f"{size:+.1%} and {depth:+.1%}", limit, ok, RUN, note))
    return out


def _formulations() -> list[Row]:
    """One-point hexahedra, the article's, beside incompatible modes."""
    out = []
    found = {"incompatible": static("1000 N")}
    changes: dict[str, str | None] = {"bodies.formulation": '"one_point"'}
    # A store of its own, which goes at once: the disk holds one set of superelements at a time.
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(store() / "kernels", Path(folder) / "kernels")
        found["one_point"] = measured(changes, Path(folder))
    one, other = found["one_point"], found["incompatible"]
    for quantity, value in (("x", _x), ("kyy", _kyy)):
        change = value(one) / value(other) - 1.0
        out.append(
            Row(
                f"one-point elements over incompatible ones, less 1: {quantity}",
                f"{change:+.2%}",
                "reported",
                True,
                typed(changes),
            )
        )
    share = one["model"]["hourglass_energy_ratio"]
    why = "elements below the contacts bend, which one point does not feel: incompatible modes, or a smaller coefficient on a finer mesh"
    out.append(below("one-point elements: hourglass energy over strain energy", share, 0.05, typed(changes), why))
    for race in ("inner", "outer"):
        ball = max(one["equilibrium"]["balls"], key=lambda ball: ball[f"load_{race}_n"])
        error = ball[f"peak_pressure_nodal_{race}_pa"] / ball[f"peak_pressure_{race}_pa"] - 1.0
        out.append(
            Row(
                f"one-point elements, {race} race: peak pressure over Hertz's, less 1",
                f"{error:+.2%}",
                "reported",
                True,
                typed(changes),
            )
        )
    note = f"memory {one['peak_bytes'] / GIB:.1f} GiB"
    return [*out, below("one-point elements: equilibrium from nothing, CPU-s", one["cpu_s"], 600.0, typed(changes), note)]


def _x(found: dict[str, Any]) -> float:
    return float(found["equilibrium"]["displacement"]["x"])


def _y(found: dict[str, Any]) -> float:
    return float(found["equilibrium"]["displacement"]["y"])


def _kyy(found: dict[str, Any]) -> float:
    return float(found["equilibrium"]["stiffness"][1][1])


def _condensed() -> list[Row]:
    """Ball loads, displacement and stiffness beside condensed bodies."""
    out = []
    for case, changes in CASES.items():
        mine, other = static(case), measured({**CONDENSED, **changes})
        loads = [np.array([ball["load_inner_n"] for ball in found["equilibrium"]["balls"]]) for found in (mine, other)]
        told = typed(dict(changes))
        apart = float(np.abs(loads[0] - loads[1]).max() / loads[1].max())
        out.append(below(f"{case}: ball loads against condensed bodies, over the largest", apart, 0.01, told))
        pairs = {"x": (_x(mine), _x(other)), "kyy": (_kyy(mine), _kyy(other))}
        if _y(other) > 1e-8:
            pairs["y"] = _y(mine), _y(other)
        for name, (value, wanted) in pairs.items():
            note = f"{value:.6g} and {wanted:.6g}"
            out.append(
                below(f"{case}: {name} against condensed bodies, relative", abs(value / wanted - 1.0), 0.01, told, note)
            )
    return out


def _former() -> list[Row]:
    """63 120 elements: superelements against the iterative solver that they replaced, in one process."""
    from raceway import load_scene
    from raceway.bodies.model import build_model
    from raceway.core.elastic.ring import ElasticRing
    from raceway.pipeline.settle import settle
    from raceway.planning.plan import make_plan

    scene = load_scene(ROOT / COARSE)
    plan = make_plan(scene)
    spent = []
    for reduced in (True, True, False):  # the first compiles
        begin = time.process_time()
        model = build_model(scene, plan)
        ring = model.system
        assert isinstance(ring, ElasticRing)
        if not reduced:
            ring.bodies.system = _iterative(ring.bodies.system)
        settle(model)
        spent.append(time.process_time() - begin)
    _, mine, former = spent
    told = f"raceway run {COARSE}"
    note = f"{mine:.1f} and {former:.0f} CPU-s, equilibrium with its 5 x 5 stiffness, compiled, in one process"
    return [
        below("63 120 elements: CPU over the iterative solver's", mine / former, 0.1, COMMAND, note),
        below(
            "63 120 elements: CPU over CalculiX's",
            mine / CALCULIX_BEARING,
            0.1,
            told,
            f"{CALCULIX_BEARING:g} CPU-s, measured before",
        ),
    ]


def _iterative(system: ElasticSystem) -> ElasticSystem:
    """The same bodies and contacts, element by element, with conjugate gradients and multigrid."""
    old = system.assembly
    assembly = Assembly(old.bodies)
    if old.cage is not None:
        assembly.hold(old.cage)
    return ElasticSystem(assembly, system.contact, old.bodies[0].operator.moduli[1], system.load)


def _reduced() -> list[Row]:
    """Three balls on a coarse mesh: every unknown of both solvers, of one discretisation, with friction left out as at any rest."""
    from raceway import load_scene
    from raceway.bodies.model import build_model
    from raceway.core.elastic.ring import ElasticRing
    from raceway.planning.plan import make_plan

    scene = load_scene(ROOT / SCENE, [f"{key}={value}" for key, value in TINY.items()])
    ring = build_model(scene, make_plan(scene)).system
    assert isinstance(ring, ElasticRing)
    system, start = ring.bodies.system, ring._undeformed(ring.surrogate, np.zeros(5))
    found = system.settle(start, 1e-10).y
    other = _iterative(system).settle(start, 1e-10).y
    apart = float(np.abs(found - other).max() / np.abs(other).max())
    note = f"{system.size} unknowns"
    return [
        below(
            "small mesh: all unknowns of the reduced against the unreduced solver, over the largest",
            apart,
            1e-8,
            COMMAND,
            note,
        )
    ]


def _plan() -> list[Row]:
    from raceway import load_scene
    from raceway.bodies.elastic.plan import elastic_cost

    out = []
    for name, changes in {**SIZES, "the article's mesh": {}}.items():
        cost = elastic_cost(load_scene(ROOT / SCENE, [f"{key}={value}" for key, value in changes.items()]))
        assert cost is not None
        found = static("1000 N") if not changes else measured(dict(changes))
        for quantity, predicted, value in (
            ("memory [GiB]", cost.bytes / GIB, found["peak_bytes"] / GIB),
            ("CPU-s", cost.equilibrium_s, found["cpu_s"]),
        ):
            ratio = predicted / value
            cells = found["model"]["mesh"]["cells"]
            note = f"{cells} elements; {predicted:.3g} predicted, {value:.3g} measured"
            command = typed(dict(changes))
            out.append(
                Row(
                    f"plan, {name}: {quantity} predicted over measured",
                    ratio,
                    "0.5 to 2",
                    0.5 <= ratio <= 2.0,
                    command,
                    note,
                )
            )
    return out
