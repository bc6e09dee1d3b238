"""Optional modules that kinds of bodies import."""

from __future__ import annotations

from raceway.planning.decisions import Balls

_KERNELS = "raceway.core.ring.kernels"
_ROOT = "raceway.core.ring.root"
#: Kernels of the balls by what they need.
_BALLS = {
    "weightless": "balls follow the ring at once",
    "inertial": "balls with centrifugal force",
    "tangential": "friction or gyroscopic moments of the balls",
}
#: Of rigid rings, which every kind has beside it for first guesses.
RIGID = (*(f"{_KERNELS}.rigid_{word}" for word in _BALLS), _ROOT)
REDUCED = ("raceway.core.condensed", "raceway.core.revolution", "raceway.core.hexahedron")
EVERY_NODE = ("raceway.core.elastic",)


def of_balls(balls: Balls) -> dict[str, str]:
    """Modules of a rigid ring: friction and gyroscopic moments are added to an equilibrium without them."""
    base = "inertial" if balls.centrifugal else "weightless"
    found = {f"{_KERNELS}.rigid_{word}": what for word, what in _BALLS.items() if word in (balls.kind, base)}
    if balls.kind == "tangential":
        found[_ROOT] = "forces on the balls have no potential"
    return found
