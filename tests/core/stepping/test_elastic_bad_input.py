"""What elastic bodies refuse: motions that nothing holds, surfaces that overlap; what a failure keeps."""

import re

import numpy as np
import pytest

from checks.validation.reference import elastic
from checks.validation.scenes import built_in
from raceway import ConvergenceError, MeshError, StabilityError
from raceway.core.fem.elastic.assembly import Assembly, Body
from raceway.core.fem.elastic.bearing import ElasticSystem
from raceway.core.fem.elastic.contact import NodalContact, Pair, PlaceLaw
from raceway.core.fem.elastic.surface import Facets, surface_points
from raceway.extend import FACES, HexOperator, Schedule, boundary, drift, integrate, linear
from tests.core.validation.impact import moving, plane

CentralDifference = built_in("integrator", "central_difference")
Newmark = built_in("integrator", "newmark")

YOUNG, SIDE = 2e11, 2e-3


def cubes(gap: float = 0.0, held: bool = True, penalty: float = 1e14) -> ElasticSystem:
    """An elastic cube above another one that is clamped at its base; ``held``: the upper one's top may only go down."""
    bodies, meshes = [], []
    for name, lift in (("upper", gap), ("lower", -SIDE)):
        points, cells = elastic.block((SIDE,) * 3, (2, 2, 2))
        points = points + [0.0, 0.0, lift]
        fixed = np.zeros(points.shape, dtype=bool)
        if name == "lower":
            fixed[points[:, 2] < -SIDE + 1e-9] = True
        elif held:
            fixed[points[:, 2] > gap + SIDE - 1e-9, :2] = True
        bodies.append(Body(name, HexOperator(points, cells, YOUNG, 0.3, 7800.0, "full"), fixed))
        meshes.append((points, cells))
    assembly = Assembly(bodies)
    first = len(meshes[0][0])
    under, top = (_facets(mesh, height) for mesh, height in zip(meshes, (gap, 0.0), strict=True))
    at = surface_points(meshes[0][0], under)
    pair = Pair("upper on lower", at, plane(np.zeros(3), np.array([0.0, 0.0, 1.0])), Facets(meshes[1][0], top), first)
    contact = NodalContact([pair], assembly.nodes, PlaceLaw(linear, np.full((len(at.area), 1), penalty)))
    force = np.zeros((assembly.nodes, 3))
    force[np.flatnonzero(meshes[0][0][:, 2] > gap + SIDE - 1e-9), 2] = -1.0
    return ElasticSystem(assembly, contact, (YOUNG / 2.0), assembly.reduced(force.ravel()))


def _facets(mesh, height):
    points, cells = mesh
    facets = boundary(cells)
    quads = cells[facets[:, :1], FACES[facets[:, 1]]]
    return quads[(np.abs(points[quads][:, :, 2] - height) < 1e-9).all(axis=1)]


def test_a_cube_on_a_cube_settles_and_carries_its_load():
    system = cubes(gap=-1e-8)
    found = system.solve_equilibrium(np.zeros(system.size))
    # Nine nodes of 1 N; Newton's residual is 1e-6 of them.
    assert system.contact.resultants()[0, 2] == pytest.approx(9.0, rel=1e-5)
    assert system.assembly.reactions(found.y)[2] == pytest.approx(9.0, rel=1e-5)


def test_a_rigid_motion_that_nothing_holds_is_named_with_the_support_that_would():
    system = cubes(held=False)
    with pytest.raises(
        ConvergenceError, match="nothing holds upper: .*constrain it by the cage, fixed nodes, or an elastic foundation"
    ):
        system.solve_equilibrium(np.zeros(system.size))


def test_an_overlap_deeper_than_an_element_is_refused_with_both_lengths():
    with pytest.raises(MeshError, match=r"upper on lower: the surfaces overlap by 1.2e\+03 µm .* \(1e\+03 µm\)"):
        cubes(gap=-1.2e-3)


def falling(system: ElasticSystem, speed: float = 0.1):
    velocity = np.zeros((system.assembly.nodes, 3))
    velocity[: system.assembly.starts[1], 2] = -speed
    return system, moving(system, velocity)


def test_a_step_above_the_stable_limit_of_elements_and_contact_is_refused_with_the_limit():
    system = cubes(gap=-1e-7, penalty=1e16)
    stepped, start = falling(system)
    state = stepped.begin(start)
    stepped.internal(0.0, 1e-9, state.u, state.v)
    limit = stepped.stable_step()
    assert limit < 0.8 * min(body.operator.stable_step() for body in system.assembly.bodies)  # the contact's part
    with pytest.raises(StabilityError, match=f"limit of central differences, {limit:.4g} s"):
        integrate(CentralDifference(), stepped, start, Schedule(1.01 * limit, 10, 1))


def test_a_contact_that_closes_later_is_held_against_the_limit_of_the_closed_one():
    stepped, start = falling(cubes(gap=1e-7, penalty=1e16))
    stepped.begin(start)
    step = 0.8 * stepped.stable_step()
    words = "s at t = .* s, where contacts have closed or stiffened. Use at least"
    with pytest.raises(StabilityError, match=words) as caught:
        integrate(CentralDifference(), stepped, start, Schedule(step, 400, 1))
    named = float(re.search(r"differences, (\S+) s at", str(caught.value))[1])
    assert named < 0.5 * step
    assert np.isfinite(caught.value.state["q"]).all()
    # What the message asks for runs through.
    again, start = falling(cubes(gap=1e-7, penalty=1e16))
    record = integrate(CentralDifference(), again, start, Schedule(0.8 * named, 400, 1))
    assert record.contact_force.max() > 0.0
    # A whole face touches within one step, which costs a sixth of the energy there; above the limit it grew beyond the first.
    assert drift(record.energies) < 0.5


@pytest.mark.parametrize("method", [CentralDifference(), Newmark()], ids=["central_difference", "newmark"])
def test_going_on_equals_never_having_stopped(method):
    dt = 0.5 * falling(cubes(gap=1e-7))[0].stable_step() if not method.implicit else 2e-7

    def run(start, first, steps):
        stepped, begin = falling(cubes(gap=1e-7))
        return integrate(method, stepped, begin if start is None else start, Schedule(dt, steps, 1, first=first))

    whole, half = run(None, 0, 40), run(None, 0, 20)
    rest = run(half.final, 20, 20)
    assert whole.contact_force.max() > 0.0
    apart = np.abs(rest.final.full_state["u"] - whole.final.full_state["u"]).max()
    # Explicit steps to the last bit; implicit ones to Newton's tolerance of 1e-9 of the forces.
    assert apart <= (1e-7 * np.abs(whole.final.full_state["u"]).max() if method.implicit else 0.0)


def test_an_equilibrium_that_is_not_found_keeps_the_last_good_state_and_the_residuals():
    system = cubes(gap=-1e-8)
    system.solve = lambda *_, **__: np.full(system.size, 1e-9)  # type: ignore[method-assign]
    with pytest.raises(ConvergenceError, match="Last good state: 0 % of the load") as caught:
        system.solve_equilibrium(np.zeros(system.size))
    assert caught.value.state["y"].shape == (system.size,)
    assert len(caught.value.state["residuals"]) > 40
