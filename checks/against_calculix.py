"""One problem, two programs: ``python -m checks.against_calculix [--load N] [--nodes N] [--deck FILE] [--scene FILE]``.

The groove case of ``checks.validation.groove``, about 10 000 elements: Raceway under the load, CalculiX on the same mesh and the same
penalty, its middle plane pressed by the approach that Raceway found.  CalculiX knows facets only; Raceway takes the gap from
the exact sphere and groove.  CPU time is that of all threads, memory that of the whole process.

With ``--scene`` the deck of a scene's bearing is written instead (``--deck`` says where; tilt locked, seats rigid); run it with
``ccx`` by hand: a bearing of 60 000 elements takes it some six minutes of CPU time.
"""

import argparse
import json
import resource
import sys
from pathlib import Path
from typing import Any

from checks import calculix
from checks.validation.groove import HERTZ, MODULUS, POISSON, YOUNG, meshes, solve
from raceway import RacewayError, SceneError
from raceway.core.fem.elastic.contact import penalty_stiffness
from raceway.extend import resolve

#: Meshes of about 10 000 elements at 4 elements per semi-axis and 300 N.
MESH = {"growth": 1.35, "coarse": 0.8e-3}
#: Elements that CalculiX is tried with: full and reduced integration.
ELEMENTS = ("C3D8", "C3D8R")
#: Of Raceway's residual, over the forces that balance; CalculiX stops at 5e-3 of the mean force.
TOLERANCE = 1e-4


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m checks.against_calculix", description=__doc__.splitlines()[0])
    parser.add_argument("--load", type=_positive, default=300.0, help="of the ball [N], default 300")
    parser.add_argument("--nodes", type=_positive, default=4.0, help="elements per semi-axis, default 4")
    parser.add_argument("--deck", type=Path, help="write CalculiX's input here and run nothing")
    parser.add_argument("--scene", type=Path, help="with --deck: the bearing of this scene in place of the groove")
    asked = parser.parse_args(words)
    if asked.scene is not None and asked.deck is None:
        parser.error("--scene needs --deck FILE: decks of whole bearings are written, not run")
    try:
        return _answer(asked)
    except (RacewayError, OSError) as why:
        print(f"error: {why}", file=sys.stderr)
        return 2


def _positive(word: str) -> float:
    value = float(word)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{word} must be greater than 0")
    return value


def _answer(asked: argparse.Namespace) -> int:
    if asked.scene is not None:
        asked.deck.write_text(scene_deck(asked.scene))
        print(f"wrote {asked.deck}", file=sys.stderr)
        return 0
    if asked.deck is not None:
        asked.deck.write_text(groove_deck(asked.load, asked.nodes, float(HERTZ.approach(asked.load))))
        print(f"wrote {asked.deck}", file=sys.stderr)
        return 0
    if calculix.installed() is None:
        print(
            f"ccx is not installed, so there is nothing to compare with: apt-get install {calculix.PACKAGE}", file=sys.stderr
        )
        return 2
    print(json.dumps(compare(asked.load, asked.nodes), indent=1))
    return 0


def compare(load: float, nodes: float) -> dict[str, Any]:
    """Both programs on the groove case: a row of Raceway, then one for each of CalculiX's elements."""
    solve(load, 1.0, **MESH)  # kernels are compiled or loaded before the time counts
    mine = solve(load, nodes, TOLERANCE, **MESH)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    rows = [_row("raceway", mine.cpu, memory, mine.newton, mine.reaction, mine.peak_points) | {"failure": ""}]
    for element in ELEMENTS:
        other = calculix.run(groove_deck(load, nodes, mine.approach, element))
        force = 4.0 * abs(float(other.reaction[2]))
        row = _row(f"CalculiX {element}", other.cpu, other.memory, other.iterations, force, other.peak_pressure)
        rows.append(row | {"failure": other.failure})
    for row in rows:
        hertz = float(HERTZ.peak_pressure(row["reaction_n"]))
        row["pressure_deviation"] = row["peak_pressure_pa"] / hertz - 1.0 if hertz > 0.0 else None
        row["reaction_deviation"] = row["reaction_n"] / load - 1.0
    solved = [row for row in rows[1:] if not row["failure"]] or rows[1:]
    case = {"case": "ball on groove, a quarter", "load_n": load, "elements_per_semi_axis": nodes, "elements": mine.cells}
    return case | {"approach_m": mine.approach, "rows": rows, "cpu_ratio": min(row["cpu_s"] for row in solved) / mine.cpu}


def groove_deck(load: float, nodes: float, approach: float, element: str = "C3D8") -> str:
    """CalculiX's input for the groove case at an approach [m], of one kind of its elements."""
    ball, block = meshes(load, nodes, **MESH)
    penalty = float(penalty_stiffness(MODULUS, float(HERTZ.semi_axes(load)[1]) / nodes))
    return calculix.groove_deck(ball, block, YOUNG, POISSON, penalty, approach, element)


def scene_deck(path: Path) -> str:
    """CalculiX's input for the bearing of a scene with [mesh]: its loads, tilt locked, seats rigid."""
    from raceway import load_scene
    from raceway.extend import contact_modulus, mesh_bodies
    from raceway.plugins.bodies.mesh import mesher_of

    scene = load_scene(path)
    if scene.mesh is None or scene.mesh.name != "structured":
        raise SceneError.at("mesh", None, "is required for a deck: [mesh] with kind = 'structured'")
    rings, balls = scene.bearing.rings, scene.bearing.balls
    modulus = contact_modulus(rings.young, rings.poisson, balls.young, balls.poisson)
    mesher = mesher_of(resolve(scene))
    _, minor = mesher._semi_axes(scene.bearing, True)
    penalty = float(penalty_stiffness(modulus, minor / mesher.nodes_per_semi_axis))
    radial = (float(scene.load.radial[0]), float(scene.load.radial[1]))
    return calculix.bearing_deck(mesh_bodies(resolve(scene)), rings.young, rings.poisson, penalty, scene.load.axial, radial)


def _row(program: str, cpu: float, memory: int, iterations: int, reaction: float, pressure: float) -> dict[str, Any]:
    spent = {"program": program, "cpu_s": cpu, "memory_bytes": memory, "iterations": iterations}
    return spent | {"reaction_n": reaction, "peak_pressure_pa": pressure}


if __name__ == "__main__":
    sys.exit(main())
