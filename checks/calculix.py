"""Decks for CalculiX, and what its answers come to.  Lengths are written in mm, forces in N, stresses in MPa."""

import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

import attrs
import numpy as np

from raceway.extend import HexMesh

#: Debian's package.
PACKAGE = "calculix-ccx"
#: Springs to the ground that hold each ball's free turning: N/mm on each of six nodes; they carry under 1 N at 30 um.
HOLD = 5.0


@attrs.frozen
class CalculixRun:
    """What a run cost and said.

    cpu : seconds of all threads;  memory : peak [bytes]
    iterations : of Newton, in all increments
    reaction : (3,) total force on the printed set [N];  peak_pressure : largest contact pressure [Pa]
    failure : what the program said where it found no solution, else ""
    """

    cpu: float
    memory: int
    iterations: int
    reaction: np.ndarray
    peak_pressure: float
    failure: str = ""


class Deck:
    """Lines of an input file: bodies, sets, contact pairs.

    bodies : body -> mesh [m];  young [Pa], poisson : of all bodies
    element : "C3D8", "C3D8R" or "C3D8I"
    """

    def __init__(self, bodies: Mapping[str, HexMesh], young: float, poisson: float, element: str = "C3D8") -> None:
        self.bodies, self.lines = dict(bodies), ["*NODE, NSET=ALL"]
        self._node, self._cell = {}, {}
        node, cell = 1, 1
        for name, mesh in self.bodies.items():
            self._node[name], self._cell[name] = node, cell
            self.lines += [f"{node + i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(1e3 * mesh.points)]
            node, cell = node + len(mesh.points), cell + len(mesh.cells)
        self._next = cell
        for name, mesh in self.bodies.items():
            self.lines.append(f"*ELEMENT, TYPE={element}, ELSET={name.upper()}")
            first = self._cell[name]
            for i, nodes in enumerate(mesh.cells + self._node[name]):
                self.lines.append(f"{first + i}, " + ", ".join(map(str, nodes)))
        self.lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{1e-6 * young:.12g}, {poisson:.12g}"]
        self.lines += [f"*SOLID SECTION, ELSET={name.upper()}, MATERIAL=STEEL" for name in self.bodies]

    def nodes(self, body: str, which: Iterable[int]) -> list[int]:
        """Numbers in the deck of a body's nodes."""
        return [int(n) + self._node[body] for n in which]

    def node_set(self, name: str, numbers: list[int]) -> None:
        self.lines.append(f"*NSET, NSET={name}")
        self.lines += [", ".join(map(str, numbers[i : i + 8])) for i in range(0, len(numbers), 8)]

    def surface(self, name: str, body: str, facets: np.ndarray) -> None:
        """A surface from facets (k, 2): their local faces are CalculiX's S1 to S6 in the same order."""
        self.lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        self.lines += [f"{cell + self._cell[body]}, S{face + 1}" for cell, face in facets]

    def contact(self, pairs: list[tuple[str, str]], stiffness: float) -> None:
        """Surface-to-surface penalty [N/m3]: (slave, master) names of surfaces."""
        self.lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        self.lines.append(f"{1e-9 * stiffness:.12g}")
        for slave, master in pairs:
            self.lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", f"{slave}, {master}"]

    def springs(self, numbers: list[int]) -> None:
        """Weak springs to the ground on nodes, in all three directions."""
        for axis in (1, 2, 3):
            self.lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=HOLD{axis}")
            self.lines += [f"{self._next + i}, {n}" for i, n in enumerate(numbers)]
            self._next += len(numbers)
            self.lines += [f"*SPRING, ELSET=HOLD{axis}", str(axis), f"{HOLD:g}"]

    def step(self, loads: list[str], printed: str, part: float) -> str:
        """The whole file: one static step, first by a part of the load; prints a set's reaction and contact pressures."""
        tail = ["*STEP, INC=100", "*STATIC, SOLVER=ITERATIVE CHOLESKY", f"{part:g}, 1.0", *loads]
        tail += [f"*NODE PRINT, NSET={printed}, TOTALS=ONLY, FREQUENCY=100", "RF"]
        tail += ["*CONTACT PRINT, FREQUENCY=100", "CSTR", "*END STEP"]
        return "\n".join(self.lines + tail) + "\n"


def groove_deck(
    ball: HexMesh, block: HexMesh, young: float, poisson: float, penalty: float, approach: float, element: str = "C3D8"
) -> str:
    """The groove case of ``checks.validation.groove`` with the approach prescribed [m]."""
    deck = Deck({"ball": ball, "race": block}, young, poisson, element)
    deck.node_set("MIDDLE", deck.nodes("ball", ball.nodes("middle")))
    deck.node_set("BASE", deck.nodes("race", block.nodes("base")))
    for side in ("side_x", "side_y"):
        deck.node_set(side.upper(), deck.nodes("ball", ball.nodes(side)) + deck.nodes("race", block.nodes(side)))
    deck.surface("BALL_SURFACE", "ball", ball.facets("surface"))
    deck.surface("RACEWAY", "race", block.facets("raceway"))
    deck.contact([("BALL_SURFACE", "RACEWAY")], penalty)
    deck.lines += ["*BOUNDARY", "BASE, 1, 3", "SIDE_X, 1, 1", "SIDE_Y, 2, 2"]
    return deck.step(["*BOUNDARY", f"MIDDLE, 3, 3, {-1e3 * approach:.12g}"], "MIDDLE", 1.0)


def bearing_deck(
    bodies: Mapping[str, HexMesh], young: float, poisson: float, penalty: float, axial: float, radial: tuple[float, float]
) -> str:
    """A bearing of a scene, tilt locked: outer seat held, inner seat a rigid body at whose node the loads act [N]."""
    deck = Deck(bodies, young, poisson)
    seat = deck.nodes("inner_ring", bodies["inner_ring"].nodes("seat"))
    last = sum(len(mesh.points) for mesh in bodies.values())
    deck.lines += ["*NODE, NSET=REFERENCE", f"{last + 1}, 0, 0, 0", f"{last + 2}, 0, 0, 0"]
    deck.node_set("BORE", seat)
    deck.node_set("OUTER", deck.nodes("outer_ring", bodies["outer_ring"].nodes("seat")))
    deck.lines.append(f"*RIGID BODY, NSET=BORE, REF NODE={last + 1}, ROT NODE={last + 2}")
    pairs = []
    for ring in ("inner_ring", "outer_ring"):
        deck.surface(ring.upper(), ring, bodies[ring].facets("raceway"))
    for name in (n for n in bodies if n not in ("inner_ring", "outer_ring")):
        mesh = bodies[name]
        deck.surface(f"{name.upper()}_S", name, mesh.facets("surface"))
        pairs += [(f"{name.upper()}_S", "INNER_RING"), (f"{name.upper()}_S", "OUTER_RING")]
        ends = np.unique([pick(mesh.points[:, axis]) for axis in range(3) for pick in (np.argmin, np.argmax)])
        deck.springs(deck.nodes(name, ends))
    deck.contact(pairs, penalty)
    deck.lines += ["*BOUNDARY", "OUTER, 1, 3", f"{last + 2}, 1, 3"]
    loads = [
        "*CLOAD",
        *(f"{last + 1}, {axis}, {force:.12g}" for axis, force in zip((1, 2, 3), (axial, *radial), strict=True)),
    ]
    return deck.step(loads, "OUTER", 0.25)


def installed() -> str | None:
    """Where the program is, or None."""
    return shutil.which("ccx")


def run(deck: str, seconds: float = 3600.0) -> CalculixRun:
    """Run a deck on one thread in a temporary folder."""
    program = installed()
    if program is None:
        raise RuntimeError(f"ccx is not installed: apt-get install {PACKAGE}")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "deck.inp").write_text(deck)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        said_in = Path(folder) / "out.txt"
        with said_in.open("w") as out:
            process = subprocess.Popen([program, "deck"], cwd=folder, stdout=out, env={"OMP_NUM_THREADS": "1"})
            memory = _watched(process, seconds)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        printed = said_in.read_text()
        data = Path(folder) / "deck.dat"
        reaction, pressure = read(data.read_text() if data.exists() else "")
        said = [line.strip() for line in printed.splitlines() if "*ERROR" in line or "diverge" in line]
        failed = process.returncode != 0 or pressure == 0.0
        why = "; ".join(said[:2]) or f"exit code {process.returncode}, no contact pressure"
        return CalculixRun(cpu, memory, printed.count(" iteration "), reaction, pressure, why if failed else "")


def _watched(process: subprocess.Popen[bytes], seconds: float) -> int:
    """Peak memory [bytes] of a process that is waited for; 0 where the system does not tell.  getrusage would not do: before
    a child has loaded its program, it counts the memory of its parent."""
    status, peak, end = Path(f"/proc/{process.pid}/status"), 0, time.monotonic() + seconds
    while process.poll() is None:
        if time.monotonic() > end:
            process.kill()
            process.wait()
            break
        with suppress(OSError):
            peak = max([peak, *(1024 * int(line.split()[1]) for line in status.read_text().splitlines() if "VmHWM" in line)])
        time.sleep(0.05)
    return peak


def read(text: str) -> tuple[np.ndarray, float]:
    """Total reaction (3,) [N] and largest contact pressure [Pa] of the last increment of a .dat file; zero where absent."""
    reaction, pressure, inside = np.zeros(3), 0.0, ""
    for line in text.splitlines():
        if not line.strip():
            continue
        words = line.split()
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            if "total force" in line:
                inside = "force"
            elif "contact" in line and "stress" in line:
                inside, pressure = "stress", 0.0
            else:
                inside = ""
            continue
        if inside == "force" and len(numbers) == 3:
            reaction = np.array(numbers)
        elif inside == "stress" and len(numbers) >= 3:
            pressure = max(pressure, 1e6 * numbers[-3])
    return reaction, pressure
