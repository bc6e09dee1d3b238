"""The largest shear stress below a contact of elastic bodies and its depth against Hertz: a ball on a groove, three meshes."""

from __future__ import annotations

from math import log2

from benchmarks.evidence import Row, near
from benchmarks.evidence._kept import kept
from validation.below_groove import Below, below

TITLE = "Elastic bodies: stresses below a contact"
COMMAND = "python -m benchmarks.evidence subsurface"
#: Elements per semi-axis -> ratio of neighbouring elements: each mesh halves those of the one before, in depth as well.
MESHES = {2.0: 2.25, 4.0: 1.5, 8.0: 1.5**0.5}
COARSE = 1e-3
#: Load [N] at which the ellipse is small against the radii of curvature, and one at which it is not: semi-axes of 0.65 and 1.4 mm on a
#: ball of 9.5 mm.
LOAD, LARGE = 100.0, 1000.0
#: The finest mesh has more than four elements down to Hertz's depth, by which a result counts it as resolving the stresses.
RESOLVED, BOUND = 4.0, 0.05
#: Second order in theory; what is left of Hertz's own error at the finest mesh takes some of it.
LEAST_RATE = 1.5


def rows() -> list[Row]:
    return kept("subsurface", [(_meshes, "incompatible"), (_meshes, "one_point"), (_meshes, "full"), _large])


def _meshes(formulation: str) -> list[Row]:
    found = [below(LOAD, nodes, formulation, growth=growth, coarse=COARSE) for nodes, growth in MESHES.items()]
    out = []
    for index, body in enumerate(("ball", "groove")):
        sides = [pair[index] for pair in found]
        where = f"{formulation}, {body}, {LOAD:g} N"
        for side in sides[:-1]:
            told = f"{_size(side):+.2%} and {_depth(side):+.2%}"
            quantity = f"{where}, {side.cells:.1f} elements down to Hertz's depth: errors of largest shear and its depth"
            out.append(
                Row(
                    quantity,
                    told,
                    "reported",
                    True,
                    COMMAND,
                    f"{side.elements} elements, {side.cpu:.1f} CPU-s; not resolved",
                )
            )
        out += _finest(where, sides[-1])
        rate = log2(abs(_depth(sides[0]) / _depth(sides[-1]))) / (len(sides) - 1)
        ok = rate >= LEAST_RATE
        out.append(
            Row(f"{where}: order of the depth's error over three meshes", rate, f"at least {LEAST_RATE:g}", ok, COMMAND)
        )
    return out


def _finest(where: str, side: Below, note: str = "") -> list[Row]:
    enough = side.cells >= RESOLVED
    cost = f"{side.elements} elements, {side.cpu:.1f} CPU-s{note}"
    return [
        Row(f"{where}: elements down to Hertz's depth", side.cells, f"at least {RESOLVED:g}", enough, COMMAND, cost),
        near(f"{where}: largest shear stress, Pa", side.shear, side.hertz_shear, BOUND, COMMAND, f"{_size(side):+.2%}"),
        near(f"{where}: its depth, m", side.depth, side.hertz_depth, BOUND, COMMAND, f"{_depth(side):+.2%}"),
    ]


def _large() -> list[Row]:
    nodes, growth = list(MESHES.items())[-1]
    why = "; as fine in units of the ellipse, which is 2.2 times as large against the radii of ball and groove"
    out = []
    for side in below(LARGE, nodes, "incompatible", growth=growth, coarse=COARSE):
        out += _finest(f"incompatible, {side.body}, {LARGE:g} N", side, why)
    return out


def _size(side: Below) -> float:
    return side.shear / side.hertz_shear - 1.0


def _depth(side: Below) -> float:
    return side.depth / side.hertz_depth - 1.0
