"""What mass that is added to small elements does to K: ``python -m checks.mass_scaling``.

The dynamic stiffness of the linearised bearing, 1 / (e . (K - w^2 M)^-1 e) of a unit force e on the ring, with all nodes in motion and the
contacts of the equilibrium; with the elements' own masses and with those for ``STEPS`` times the smallest step of an element.  The error
that a run would state is the kinetic energy of the added mass beyond that of the ring as a rigid body (``raceway.pipeline.uncertainty``).
The bearing of 63 120 elements has a penalty of 3e15 N/m3: with that of 1 % of Hertz's approach the contacts allow 2.2 ns, less than its elements.
"""

import json
from typing import Any

import numpy as np

import raceway as rw
from raceway.extend import solve_equilibrium

#: Times the smallest stable step of an element; speed [r/min].
STEPS, RPM = 3.0, 12_000.0
SCENES = {"examples/b7206_elastic_coarse.toml": [], "checks/b7206_elastic_60k.toml": ["contact.stiffness=3e15"]}


def stiffness(scene: Any) -> dict[str, float]:
    """K in both radial directions, what is stated of it, and the steps [s] of elements and contacts."""
    model = rw.build_model(scene)
    solve_equilibrium(model)
    system = model.bearing.bearing.system
    assembly, w = system.assembly, RPM * np.pi / 30.0
    found: dict[str, float] = {"element_step_s": system.element_step(), "step_s": system.stable_step()}
    for name, direction in (("y", 1), ("z", 2)):
        force = np.eye(1, system.size, direction)[0]
        motion = system.solver.solve(1.0, 0.0, -(w**2), force, 1e-11)
        k = 1.0 / motion[direction] + model.mass_used * w**2
        u = assembly.nodal(motion) / motion[direction]
        extra = np.repeat(assembly.added_mass, 3) @ u**2 - assembly.added_inertia()[1, 1]
        found |= {f"k_{name}": float(k), f"stated_{name}": float(extra * w**2 / k)}
    outer = slice(assembly.starts[1], assembly.starts[2])
    added, own = (float(mass.sum() - mass[outer].sum()) for mass in (assembly.added_mass, assembly.own_mass))
    return found | {"ring_gains_kg": float(assembly.added_inertia()[1, 1]), "added_share_of_moving_mass": added / own}


def measure(path: str, changes: list[str]) -> dict[str, float]:
    """Relative change of K by the larger step, beside what is stated."""
    motion = ["excitation.kind=bidirectional", f"excitation.speed_rpm={RPM}", "excitation.unbalance=1e-4"]
    scene = rw.evolve(
        rw.load_scene(path), "bodies.formulation=one_point", "integrator.kind=central_difference", *motion, *changes
    )
    own = stiffness(scene)
    scaled = stiffness(rw.evolve(scene, f"integrator.least_step={STEPS * own['element_step_s']!r}"))
    return scaled | {f"change_{name}": scaled[f"k_{name}"] / own[f"k_{name}"] - 1.0 for name in "yz"}


if __name__ == "__main__":
    for path, changes in SCENES.items():
        print(json.dumps({path: measure(path, changes)}, indent=1), flush=True)
