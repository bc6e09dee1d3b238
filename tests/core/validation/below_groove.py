"""The largest shear stress below the quarter model of a ball on a groove, in ball and groove, beside Hertz's."""

import time

import attrs
import numpy as np

from checks.validation.groove import DENSITY, HERTZ, POISSON, RADIUS, YOUNG, guess, model
from checks.validation.quarter import unfolded
from raceway.core.contact.hertz import largest_shear
from raceway.core.fem.elastic.stress import ContactAxis, stress_profile
from raceway.extend import HexOperator


@attrs.frozen
class Below:
    """One body.

    body : "ball" or "groove";  elements : of the whole model;  cells : down to Hertz's depth
    shear, hertz_shear [Pa];  depth, hertz_depth [m]
    cpu : seconds to make the model and solve it
    """

    body: str
    elements: int
    cells: float
    shear: float
    depth: float
    hertz_shear: float
    hertz_depth: float
    cpu: float


def below(load: float, nodes: float, formulation: str, **mesh: float) -> list[Below]:
    """Ball and groove under a load [N] of the whole ball, with so many elements per semi-axis; ``mesh``: see ``groove.meshes``."""
    begin = time.process_time()
    # Sizes of the mesh by name, as callers give them: their types are those of `model`.
    found = model(load, nodes, formulation, **mesh)  # type: ignore[arg-type]
    state = found.system.solve_equilibrium(guess(found, float(HERTZ.approach(load))))
    cpu = time.process_time() - begin
    semi_axes = tuple(float(x) for x in HERTZ.semi_axes(load))
    # Two semi-axes, which a generator does not tell the type checker.
    shear, depth = largest_shear(semi_axes, float(HERTZ.peak_pressure(load)), POISSON)  # type: ignore[arg-type]
    assembly, out = found.system.assembly, []
    moved = assembly.nodal(state.y)
    # x across the groove, y along the rolling direction, z from the groove to the ball.
    for index, (word, mesh_, into) in enumerate((("ball", found.ball, 1.0), ("groove", found.block, -1.0))):
        u = moved[assembly.part(index)].reshape(-1, 3)
        points, cells, u = unfolded(mesh_.points, mesh_.cells, u)
        body = HexOperator(points, cells, YOUNG, POISSON, DENSITY, formulation)
        axis = ContactAxis(np.array([0.0, 0.0, -RADIUS]), np.diag([1.0, 1.0, into]))
        profile = stress_profile(axis, body, u, 1.5 * semi_axes[0], 3.0 * depth)
        size, place = profile.largest()
        out.append(Below(word, found.cells, profile.cells_to(depth), size, place, shear, depth, cpu))
    return out
