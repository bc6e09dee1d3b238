"""A bearing as the node of a rotor meets it: Z of small motions, motion under a load, force of a displacement.

Knows nothing of ROSS; x is the bearing's axis.
"""

from __future__ import annotations

from math import pi
from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import default_registry
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import simulate
from raceway.planning.plan import make_plan
from raceway.scene.given import as_scene
from raceway.scene.tables import Identifying, Integration, Rotor, Scene
from raceway.studies.ross.harmonic_load import harmonic_load
from raceway.studies.ross.secant import secant

#: Below this the derivative of Z by j w stands for C [rad/s].
_SLOW = 1e-3
_MOST, _TOLERANCE = 50, 1e-10


@attrs.frozen(eq=False)
class NodeBearing:
    """One bearing under a rotor.

    Attributes
    ----------
    scene : static, its ring free along x
    tilts : whether the node's own tilts are the ring's
    damping : added to all translations [N s/m]
    """

    scene: Scene
    tilts: bool = False
    damping: float = 0.0
    _rest: dict[float, tuple[Model, Equilibrium]] = attrs.field(factory=dict, init=False, repr=False)

    @property
    def size(self) -> int:
        """Coordinates that the node shares with the ring: x, y, z, and the tilts about y and z."""
        return 5 if self.tilts else 3

    def at_rest(self, speed: float) -> tuple[Model, Equilibrium]:
        """Model and equilibrium of the ring that turns with a speed [rad/s]."""
        if speed not in self._rest:
            self._rest.clear()  # one is asked for again and again; models of elastic bodies are large
            kinematics = attrs.evolve(self.scene.kinematics, spin_speed_rpm=speed * 30.0 / pi)
            scene = attrs.evolve(self.scene, kinematics=kinematics)
            model = build_model(scene, make_plan(scene))
            self._rest[speed] = model, settle(model)
        return self._rest[speed]

    def dynamic_stiffness(self, frequency: float, speed: float) -> np.ndarray:
        """Z = K + j w C (n, n) of small motions at w = frequency, the ring turning with a speed [rad/s]."""
        w = max(abs(frequency), _SLOW)
        model, rest = self.at_rest(speed)
        system = model.system
        now = system.evaluate(rest.displacement, ball=rest.ball)
        whole = rest.stiffness + system.stiffness + 1j * w * (now.damping + system.damping)
        whole[:3, :3] += 1j * w * self.damping * np.eye(3)
        inside = [i for i in range(self.size, 5) if system.free[i] > 0.0]
        seen = whole[: self.size, : self.size]
        if inside:
            seen = seen - whole[: self.size, inside] @ np.linalg.solve(
                whole[np.ix_(inside, inside)], whole[inside, : self.size]
            )
        return seen

    def motion(self, speed: float, load: np.ndarray) -> np.ndarray:
        """Complex amplitudes (n,) of the ring under a synchronous load (n,), without inertia: what the contacts carry.

        Raises
        ------
        ConvergenceError
            A load that the bearing cannot carry.
        """
        whole = np.zeros(5, dtype=complex)
        whole[: self.size] = load
        scene = attrs.evolve(self.at_rest(speed)[0].scene, excitation=harmonic_load(speed, whole))
        model = build_model(scene, make_plan(scene))
        record = simulate(model, settle(model)).record
        turning = np.exp(-1j * speed * record.time) * (2.0 / len(record.time))
        return np.asarray(turning @ record.displacement[:, : self.size])

    def stiffness_on(self, speed: float, load: np.ndarray, motion: np.ndarray) -> np.ndarray:
        """Z (n, n) that carries a motion under its load: the smallest symmetric change of the stiffness of small motions."""
        small = self.dynamic_stiffness(speed, speed)
        unit = np.array([1.0, 1.0, 1.0, *[self.at_rest(speed)[0].system.arm] * 2])[: self.size]
        return secant(small.real, motion, load, unit) + 1j * small.imag

    def force(self, speed: float, displacement: np.ndarray) -> np.ndarray:
        """Force (n,) of the ring against a displacement (n,) from its equilibrium [N, N m]; damping is not in it.

        Raises
        ------
        ConvergenceError
            A displacement at which the balls, or tilts that the node does not share, find no place.
        """
        model, rest = self.at_rest(speed)
        system, n = model.system, self.size
        q = rest.displacement.copy()
        q[:n] += displacement
        inside = [i for i in range(n, 5) if system.free[i] > 0.0]
        for _ in range(_MOST):
            now = system.evaluate(q, ball=rest.ball)
            left = now.force + system.stiffness @ q - system.load
            if not inside or np.abs(left[inside]).max() <= _TOLERANCE * system.arm * np.abs(now.contact_force).max():
                return np.asarray(left[:n])
            tangent = (now.stiffness + system.stiffness)[np.ix_(inside, inside)]
            q[inside] -= np.linalg.solve(tangent, left[inside])
        raise ConvergenceError(f"the ring finds no tilt at the displacement {np.array2string(displacement, precision=3)} m")


def node_bearing(bearing: Any, preload: float | None, tilt: float | str | None, damping: float) -> NodeBearing:
    """The bearing of a preset or a scene.

    Parameters
    ----------
    bearing : name of a preset, or Scene, path, TOML text, dict of tables
    preload : axial load [N]; None: the scene's own
    tilt : "locked", "free", "node" (the node's tilts are the ring's) or a stiffness [N m/rad]; None: the scene's supports.tilt

    Raises
    ------
    SceneError
        With every mistake that was found.
    """
    scene = as_scene({"bearing": {"preset": bearing}} if _is_preset(bearing) else bearing)
    tables: dict[str, Any] = {"supports": {"axial": "force"}}
    if preload is not None:
        tables["load"] = {"axial": preload}
    if tilt is not None:
        tables["supports"]["tilt"] = "free" if tilt == "node" else tilt
    if not damping >= 0.0 or not np.isfinite(damping):
        raise SceneError.at("damping", damping, "must be a finite damping of at least 0 N s/m")
    if scene.contact.friction > 0.0:
        rule = "takes work from every motion, which a stiffness does not tell: set it to 0 and give `damping` instead"
        raise SceneError.at("contact.friction", scene.contact.friction, rule)
    scene = as_scene(scene, tables)
    find = default_registry().find
    scene = attrs.evolve(
        scene,
        rotor=Rotor(damping=scene.rotor.damping),
        excitation=None,
        integrator=Integration(kind="quasi_static", method=find("integrator", "quasi_static").plugin()),
        identifier=Identifying(method=find("identifier", "fft_1x").plugin()),
    )
    return NodeBearing(scene, tilt == "node", damping)


def _is_preset(bearing: Any) -> bool:
    return isinstance(bearing, str) and not any(sign in bearing for sign in "./\\\n=[")
