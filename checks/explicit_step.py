"""An explicit step of elastic bodies on the article's mesh, one thread against all: ``python -m checks.explicit_step``.

CPU times are minima over steps; the forces of the elements alone are measured in the same run.
"""

import json
import time
from typing import Any

import numpy as np

from checks.kernel import least
from raceway import load_scene
from raceway.core.fem.elastic.bearing import ElasticBearing
from raceway.core.fem.elastic.bearing_data import BearingData
from raceway.core.fem.elastic.contact import penalty_stiffness
from raceway.extend import Recorder, Schedule, State, ThreadPool, linear, make_basis, mesh_bodies, resolve, usable_cores

#: The article's mesh.
ARTICLE = "examples/b7206_article_mesh.toml"
#: Axial displacement that presses the balls [m], and the step [s], so small that the state hardly changes.
_PRESSED, _STEP = 1e-5, 1e-12
#: Elements times steps of the longer of two calls, whose difference is that of the steps alone; calls of which the quickest counts.
_WORK, _CALLS = 4_000_000, 8
#: How often one thread and all of them take turns.
_ROUNDS = 3


def bearing(scene: Any) -> ElasticBearing:
    """The bearing of a scene with one-point hexahedra, a penalty and friction 0.03, without equilibrium or plan."""
    basis, b = make_basis(resolve(scene)), scene.bearing
    modulus = basis.modulus

    def params(pair: np.ndarray, area: np.ndarray) -> np.ndarray:
        return penalty_stiffness(modulus, 2.0 * np.sqrt(area))[:, None]

    data = BearingData(
        geometry=basis.geometry, azimuth=basis.azimuth, rings=(b.rings.young, b.rings.poisson, b.rings.density),
        balls=(b.balls.young, b.balls.poisson, b.balls.density), reference_load=basis.ball_load, law=linear, params=params,
        mass=np.diag([0.5, 0.5, 0.5, 1e-4, 1e-4]), free=np.ones(5, dtype=bool), load=np.array([1000.0, 0.0, 0.0, 0.0, 0.0]),
        formulation="one_point", friction=0.03,
    )  # fmt: skip
    return ElasticBearing(mesh_bodies(resolve(scene)), data)


def pressed(built: ElasticBearing) -> State:
    """Bodies at rest, undeformed, that overlap; the contacts begin there."""
    assembly, contact = built.system.assembly, built.system.contact
    assert contact is not None
    held = np.tile([0.0, 0.5 * built.setup.geometry.pitch_diameter], (built.ball_count, 1)) - built.setup.offsets[1]
    y = built.guess(np.array([_PRESSED, 0.0, 0.0, 0.0, 0.0]), held)
    contact.restore(contact.place, np.zeros_like(contact.memory))
    built.system.locate(y)
    if contact.friction is not None:
        contact.friction.begin((contact.move @ assembly.nodal(y)).reshape(-1, 3))
    zero = np.zeros(built.system.size)
    return State(y, zero, zero.copy())


def steps(built: ElasticBearing, threads: int) -> tuple[float, State]:
    """CPU time of the quickest step [s], and the state after all."""
    system = built.system
    system.assembly.threads = ThreadPool(threads)
    start = pressed(built)
    few, many = 2, 2 + max(2, _WORK // built.cells)
    with system.threads:
        recorder = Recorder(system, start, Schedule(_STEP, many, 1, many), None)
        ahead = system.explicit(_STEP, "cpu")
        assert ahead is not None
        short, long = (
            least(lambda count=count: ahead.take(recorder, count), _CALLS, time.process_time) for count in (few, many)
        )
        return (long - short) / (many - few), ahead.take(recorder, many)[0]


def forces_s(built: ElasticBearing) -> float:
    """CPU time of the forces of all elements, one body after the other by one thread [s]."""
    assembly = built.system.assembly
    u = 1e-9 * np.random.default_rng(0).standard_normal(3 * assembly.nodes)
    parts = [(body.operator, u[assembly.part(k)]) for k, body in enumerate(assembly.bodies)]
    out = [np.empty_like(body.points) for body in assembly.bodies]

    def all_of_them() -> None:
        for (operator, part), force in zip(parts, out, strict=True):
            operator.internal_force(part, force)

    return least(all_of_them, 7)


def measure() -> dict[str, Any]:
    """Ratios of CPU times, one thread's and that of all cores that this process may use; whether both give the same digits."""
    built = bearing(load_scene(ARTICLE))
    force = forces_s(built)
    # In turns, so that what else the machine does hits both alike.
    rounds = [[steps(built, count) for count in (1, usable_cores())] for _ in range(_ROUNDS)]
    one, all_of_them = (min(each[k][0] for each in rounds) for k in (0, 1))
    alone, shared = (state for _, state in rounds[0])
    same = all(np.array_equal(getattr(alone, name), getattr(shared, name)) for name in ("u", "v", "a"))
    return {"elements": built.cells, "step_over_forces": one / force, "cpu_ratio": all_of_them / one, "same_digits": same}


if __name__ == "__main__":
    print(json.dumps(measure(), indent=1))
