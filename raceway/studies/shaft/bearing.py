"""Response of the scene's bearing to a turning force and moment, by ``raceway.pipeline.run``."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.scene.scene import Scene
from raceway.scene.tables import Identifying, Rotor
from raceway.studies.shaft.shaft_load import shaft_load


@attrs.frozen(eq=False)
class Bearing:
    """One bearing of the rig.

    Attributes
    ----------
    scene : with the axial load; free to tilt and without a rotor's mass, which are the shaft's
    compliance : (2, 2) of deflection and slope by force and moment, tangent at rest [m/N, 1/N; 1/N, rad/(N m)]
    mass : of the inner ring [kg]; 0 with an integrator that knows no inertia
    last : the last result, if there is one, whose motion the next one continues; see ``anew``
    given : the answers since ``anew``, four numbers each;  known : answers that a course of the same questions got before
    """

    scene: Scene
    registry: Registry
    compliance: np.ndarray
    mass: float
    last: list[Result] = attrs.field(factory=list, repr=False)
    given: list[list[float]] = attrs.field(factory=list, repr=False)
    known: list[list[float]] = attrs.field(factory=list, repr=False)

    def anew(self, known: Iterable[list[float]] = ()) -> Bearing:
        """The same bearing without a motion to continue: what is found with it depends on nothing that was found before.

        Parameters
        ----------
        known : ``given`` at the end of an earlier course, which the same questions get again without a run
        """
        return attrs.evolve(self, last=[], given=[], known=list(known))

    @property
    def coupling(self) -> float:
        """Force by tilt at rest [N/rad]."""
        return float(np.linalg.inv(self.compliance)[0, 1])

    def answer(self, speed: float, force: complex, moment: complex) -> np.ndarray:
        """Deflection [m] and slope [rad] (2,) of the inner ring in forward whirl, with its inertia.

        Parameters
        ----------
        speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]

        Raises
        ------
        ConvergenceError
            No steady motion.
        """
        if len(self.given) < len(self.known):
            self.given.append(self.known[len(self.given)])
            return np.array(self.given[-1]).view(complex)
        scene = attrs.evolve(self.scene, excitation=shaft_load(speed * 30.0 / pi, force, moment))
        # Loads that are tried one after another belong to one motion of the rig.
        found = run(scene, self.registry, near=self.last[0] if self.last else None, stay=True)
        self.last[:] = [found]
        simulation = found.simulation
        assert simulation is not None  # a scene with an excitation and an identifier that needs a record
        record = simulation.record
        q = record.displacement
        turning = np.exp(-1j * speed * record.time) / len(record.time)
        answer = np.array([turning @ (q[:, 1] + 1j * q[:, 2]), turning @ (q[:, 4] - 1j * q[:, 3])])
        self.given.append(answer.view(float).tolist())
        return answer


def bearing(scene: Scene, axial: float, registry: Registry) -> Bearing:
    """The scene's bearing as it sits in the rig under an axial load [N].

    Raises
    ------
    SceneError
        A scene whose bearing is not the same all around.
    """
    if any(scene.load.radial) or any(scene.load.moment):
        raise SceneError.at(
            "load", None, "the rig is taken to whirl in circles: leave `load.radial` and `load.moment` at zero"
        )
    if scene.bearing.arrangement != "single":
        raise SceneError.at("bearing.arrangement", scene.bearing.arrangement, "the rig has single bearings: 'single'")
    free = attrs.evolve(
        scene,
        load=attrs.evolve(scene.load, axial=axial),
        supports=attrs.evolve(scene.supports, tilt="free"),
        rotor=Rotor(damping=scene.rotor.damping),
        excitation=None,
        identifier=Identifying(method=registry.find("identifier", "fft_1x").plugin()),  # the motion is read here, not there
    )
    still = run(free, registry)
    stiffness = still.equilibrium.stiffness
    chosen = np.ix_([1, 4], [1, 4])  # y and theta_z; by symmetry the same for z and -theta_y
    return Bearing(free, registry, np.linalg.inv(stiffness[chosen]), still.model.mass_used)
