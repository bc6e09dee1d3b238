"""Single numbers of the model and of examples: pressures, sticking, the inner ring as a solid, a good elastic example."""

from __future__ import annotations

import numpy as np

from benchmarks.evidence import Row, below, near
from benchmarks.evidence._files import ROOT
from raceway import load_scene
from raceway.bodies.condensed.kind import Condensed
from raceway.bodies.meshing import mesh_scene
from raceway.pipeline.run import run
from raceway.scene.inner_ring import radial_growth, ring_inertia
from raceway.scene.reading import scene_from_dict
from validation.reference.rotating_ring import growth_by_elements

TITLE = "Single numbers: pressure of a penalty, sticking, the inner ring as a solid, the elastic example"
COMMAND = "python -m benchmarks.evidence details"
_PENALTY = 1e15


def rows() -> list[Row]:
    return [*_penalty(), _sticking(), *_ring(), *_example()]


def _scene(**tables: object) -> dict[str, object]:
    return {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, **tables}


def _penalty() -> list[Row]:
    command = "raceway run examples/b7206.toml --set contact.kind=penalty"
    stiff = run(scene_from_dict(_scene(contact={"kind": "penalty", "stiffness": _PENALTY})))
    ball = stiff.to_dict()["equilibrium"]["balls"][0]
    own = _PENALTY * -float(stiff.equilibrium.gap[0])
    hertz = 1e-6 * float(stiff.model.inner.peak_pressure(ball["load_inner_n"]))
    plain = run(scene_from_dict(_scene()))
    load = plain.to_dict()["equilibrium"]["balls"][0]["load_inner_n"]
    found = run(scene_from_dict(_scene(contact={"kind": "penalty", "calibrate_at": load}))).error["contact"]
    words = "penalty, rigid bodies: error.contact where its approach is Hertz's"
    return [
        near(
            "penalty of 1e15 N/m3, rigid bodies: peak pressure of the inner race over k delta",
            ball["peak_pressure_inner_pa"] / own, 1.0, 1e-9, f"{command} --set contact.stiffness=1e15",
            f"{1e-6 * own:.0f} MPa; Hertz {hertz:.0f} MPa at the same load",
        ),
        near(words, found, 1.0 / 3.0, 1e-3, f"{command} --set contact.calibrate_at={load:.1f}", "its stiffness is 2 Q / delta"),
    ]  # fmt: skip


def _sticking() -> Row:
    from scipy.integrate import quad

    model = run(scene_from_dict(_scene())).model
    poisson, ellipse = 0.29, model.inner
    a, b = (float(axis) for axis in ellipse.semi_axes(250.0))

    def ray(theta: float, tangential: bool) -> float:
        length = 1.0 / np.hypot(np.cos(theta) / a, np.sin(theta) / b)
        return float(length * (1.0 - poisson + (poisson * np.cos(theta) ** 2 if tangential else 0.0)))

    sums = [quad(ray, 0.0, 0.5 * np.pi, args=(tangential,), epsrel=1e-11)[0] for tangential in (False, True)]
    note = "along the groove; a circle has 0.830"
    words = "stiffness of a sticking contact over the normal one, inner race of B7206C, against Cerruti's integral"
    return near(words, ellipse.stick_ratio(poisson)[0], sums[0] / sums[1], 1e-9, COMMAND, note)


def _ring() -> list[Row]:
    turning = {"kinematics": {"ring_growth": True, "spin_speed_rpm": 30000.0}}
    out = []
    for words, change in (("B7206C", {}), ("bore 33 mm", {"bore": 33e-3}), ("width 14 mm", {"width": 14e-3})):
        scene = scene_from_dict({**_scene(**turning), "bearing": {"preset": "B7206C", **change}})
        exact, found = growth_by_elements(scene), radial_growth(scene)
        quantity = f"growth of the turning inner ring, {words}: against finite elements, less 1"
        out.append(below(quantity, abs(found / exact - 1.0), 0.01, COMMAND, f"{1e6 * found:.4f} um at 30 000 r/min"))
    mesh = {"kind": "structured", "element_size": 0.5e-3, "nodes_per_semi_axis": 2}
    scene = scene_from_dict({**_scene(), "mesh": mesh})
    ring = mesh_scene(scene)["inner_ring"]
    place, volume = ring.points[ring.cells].mean(axis=1), ring.cell_volumes()
    solid = scene.bearing.rings.density * float(volume @ (0.5 * (place[:, 1] ** 2 + place[:, 2] ** 2) + place[:, 0] ** 2))
    quantity = "inner ring's transverse inertia against 0.5 mm hexahedra, less 1"
    out.append(below(quantity, abs(ring_inertia(scene)[1] / solid - 1.0), 0.005, COMMAND, "chords, cells as points"))
    return out


def _example() -> list[Row]:
    from attrs import evolve

    name = "examples/b7206_elastic.toml"
    scene = load_scene(ROOT / name)
    condensed = evolve(scene, bodies=Condensed(), mesh=None)
    found, other = (run(each).to_dict() for each in (scene, condensed))
    kyy, expected = (each["equilibrium"]["stiffness"][1][1] for each in (found, other))
    pressure, hertz = (each["equilibrium"]["balls"][0]["peak_pressure_inner_pa"] for each in (found, other))
    command = f"raceway run {name}"
    return [
        below("elastic example: kyy against condensed bodies, less 1", abs(kyy / expected - 1.0), 0.01, command,
              f"{1e-6 * kyy:.1f} and {1e-6 * expected:.1f} N/um"),
        below("elastic example: peak pressure against condensed bodies, less 1", abs(pressure / hertz - 1.0), 0.01, command,
              f"{1e-6 * pressure:.0f} and {1e-6 * hertz:.0f} MPa"),
    ]  # fmt: skip
