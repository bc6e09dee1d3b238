"""From scene and plan to arrays and kernels."""

from __future__ import annotations

from collections.abc import Callable
from math import pi, radians
from typing import Any

import attrs
import numpy as np

from raceway.contracts import ContactPairs
from raceway.core.bodies import ring
from raceway.core.geometry import BallBearing
from raceway.core.hertz import Ellipse, contact_modulus
from raceway.core.plugin_kernel import plugin_kernel
from raceway.core.signatures import FORCE, LAW
from raceway.core.system import System
from raceway.errors import PluginError, RacewayError
from raceway.estimate import axial_approach
from raceway.plan import Plan
from raceway.probe import probe_excitation, probe_law
from raceway.ring import radial_growth, ring_inertia
from raceway.scene import Scene


@attrs.frozen(eq=False)
class Model:
    """Everything that a run computes with.

    Attributes
    ----------
    geometry : lengths of the row;  inner, outer : load-independent Hertz contacts
    azimuth : (Z,) at time zero, rows one after the other [rad];  guess : (5,) first guess of the equilibrium, with a held axial displacement
    """

    scene: Scene
    plan: Plan
    geometry: BallBearing
    inner: Ellipse
    outer: Ellipse
    azimuth: np.ndarray
    system: System
    guess: np.ndarray

    @property
    def excitation(self) -> Any:
        return self.scene.excitation

    @property
    def mass_used(self) -> float:
        """m of K = Re Z + m w^2 [kg]: that of the ring and its share of the rotor; 0 without inertia forces."""
        return float(self.system.mass[1, 1]) if self.scene.integrator.method.inertial else 0.0


def build_model(scene: Scene, plan: Plan) -> Model:
    """Arrays and kernels of a scene.

    Raises
    ------
    PluginError
        A law that builds parameters of a wrong shape.
    ConvergenceError
        No equilibrium under the axial load whose displacement is to be held.
    """
    b = scene.bearing
    geometry = BallBearing(
        b.ball_diameter, b.pitch_diameter, b.ball_count, b.contact_angle, b.conformity_inner, b.conformity_outer
    )
    modulus = contact_modulus(b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson)
    inner, outer = geometry.ellipses(modulus)
    single = radians(b.first_ball_azimuth_deg) + 2.0 * pi * np.arange(b.ball_count) / b.ball_count
    azimuth = np.tile(single, len(b.rows))
    x, ball_load = axial_approach(scene)
    reference = max(ball_load, 1.0)
    kernel, base = _bodies_kernels(plan)
    system = System(
        kernel=kernel,
        base_kernel=base,
        law=plugin_kernel(scene.contact.law, "contact law", LAW, "LAW"),
        law_params=_law_params(scene, inner, outer, modulus, reference),
        law_state=np.zeros((2 * len(azimuth), scene.contact.law.state_size)),
        scalars=_scalars(scene, plan, geometry, inner, outer, reference),
        table=_ball_table(scene, plan, geometry, inner, outer, azimuth),
        **_linear_parts(scene, plan),
        load=np.array([scene.load.axial, *scene.load.radial, *scene.load.moment]),
        **_excitation(scene),
    )
    # As deep as the scene's own load presses, and well beyond: loads of single balls are many times the mean.
    approach = float(inner.approach(reference + 5.0 * max(np.abs(system.load[:3]).max(), 1.0) / len(azimuth)))
    depths = [factor * approach for factor in (0.3, 1.0, 3.0, 10.0)]
    probe_law(scene.contact.law, system.law, system.law_params, system.law_state, depths=depths)
    if scene.excitation is not None:
        probe_excitation(scene.excitation, system.force, system.force_params)
    guess = _first_guess(scene, geometry, x)
    if b.preload > 0.0:
        system.table[:, ring.SHIFT] = _preload_shift(scene, system, geometry)
        guess[0] = 0.0
    if scene.supports.axial == "displacement":
        guess = _alone(system, scene.load.axial, guess)
    return Model(scene, plan, geometry, inner, outer, azimuth, system, guess)


def _alone(system: System, axial: float, guess: np.ndarray) -> np.ndarray:
    """(5,) equilibrium under an axial load alone, the other coordinates held."""
    start = np.array([guess[0], 0.0, 0.0, 0.0, 0.0])
    load = np.array([axial, 0.0, 0.0, 0.0, 0.0])
    return attrs.evolve(system, load=load, free=np.array([1.0, 0.0, 0.0, 0.0, 0.0])).settle(start)[0]


def _preload_shift(scene: Scene, system: System, geometry: BallBearing) -> float:
    """Axial approach [m] at which one row carries the preload: built into both rows of a pair."""
    z = geometry.ball_count
    table = system.table[:z].copy()
    table[:, ring.SIDE], table[:, ring.LEVER] = 1.0, 0.0
    chosen = np.r_[0:z, system.ball_count : system.ball_count + z]
    params = np.ascontiguousarray(system.law_params[chosen])
    row = attrs.evolve(system, table=table, law_params=params, law_state=system.law_state[chosen].copy())
    guess = np.array([0.05 * geometry.centre_distance, 0.0, 0.0, 0.0, 0.0])
    return float(_alone(row, scene.bearing.preload, guess)[0])


def _bodies_kernels(plan: Plan) -> tuple[Any, Any]:
    """The plan's kernel, and the one whose forces have a potential."""
    if plan.centrifugal:
        from raceway.core.bodies.rigid_inertial import rigid_inertial as base
    else:
        from raceway.core.bodies.rigid_weightless import rigid_weightless as base
    if plan.balls != "tangential":
        return base, base
    from raceway.core.bodies.rigid_tangential import rigid_tangential

    return rigid_tangential, base


def _scalars(
    scene: Scene, plan: Plan, geometry: BallBearing, inner: Ellipse, outer: Ellipse, reference: float
) -> np.ndarray:
    b, kinematics = scene.bearing, scene.kinematics
    out = np.zeros(ring.SCALARS)
    cage = geometry.cage_speed(scene.spin_speed)
    out[ring.REST_AXIAL], out[ring.REST_RADIAL] = geometry.rest
    out[ring.REST_RADIAL] += radial_growth(scene)
    out[ring.OFFSET_INNER], out[ring.OFFSET_OUTER] = geometry.offset_inner, geometry.offset_outer
    out[ring.TILT_ARM] = geometry.inner_centre_radius if b.tilt_arm == "groove" else 0.5 * b.pitch_diameter
    out[ring.DAMPING] = scene.contact.damping
    if kinematics.orbiting:
        out[ring.CAGE] = cage
    out[ring.DIAMETER] = geometry.ball_diameter
    if scene.contact.friction > 0.0:
        out[ring.FRICTION] = scene.contact.friction
        out[ring.STICK] = scene.contact.stick_stiffness or _stick_stiffness(scene, inner, outer, reference)
    if plan.gyroscopic:
        shares = {"outer_race": (0.0, 2.0), "shared": (1.0, 1.0)}[kinematics.gyroscopic]
        out[ring.SHARE_INNER], out[ring.SHARE_OUTER] = shares
        out[ring.BALL_OVER_PITCH] = geometry.ball_diameter / geometry.pitch_diameter
        moment_of_inertia = geometry.ball_mass(b.balls.density) * geometry.ball_diameter**2 / 10.0
        out[ring.GYROSCOPIC] = moment_of_inertia * scene.spin_speed * cage
    return out


def _stick_stiffness(scene: Scene, inner: Ellipse, outer: Ellipse, load: float) -> float:
    """Tangential stiffness [N/m] of a sticking contact: 2 (1 - nu) / (2 - nu) of the normal one (Mindlin 1949)."""
    nu = 0.5 * (scene.bearing.rings.poisson + scene.bearing.balls.poisson)
    normal = [1.5 * load / float(e.approach(load)) for e in (inner, outer)]
    return 2.0 * (1.0 - nu) / (2.0 - nu) * 0.5 * sum(normal)


def _made_by(who: str, duty: str, make: Callable[[], Any]) -> np.ndarray:
    """An array from a plug-in's own code, whose failures are put to its name."""
    try:
        return np.ascontiguousarray(make(), dtype=float)
    except RacewayError:
        raise
    except Exception as why:  # a third party's own code
        raise PluginError(f"{who}: {duty} raises {type(why).__name__}: {why}") from why


def _law_params(scene: Scene, inner: Ellipse, outer: Ellipse, modulus: float, ball_load: float) -> np.ndarray:
    z = scene.bearing.ball_count * len(scene.bearing.rows)

    def both(a: float, b: float) -> np.ndarray:
        return np.repeat([a, b], z).astype(float)

    pairs = ContactPairs(
        curvature_a=both(inner.curvatures[0], outer.curvatures[0]),
        curvature_b=both(inner.curvatures[1], outer.curvatures[1]),
        contact_modulus=both(modulus, modulus),
        hertz_factor=both(inner.factor, outer.factor),
        reference_load=both(ball_load, ball_load),
    )
    params = _made_by(f"contact law '{scene.contact.kind}'", "build()", lambda: scene.contact.law.build(pairs))
    if params.ndim != 2 or len(params) != 2 * z:
        raise PluginError(
            f"contact law '{scene.contact.kind}': build() returned parameters of shape {params.shape}; "
            f"it must be ({2 * z}, k): a row for each ball-race pair"
        )
    return params


def _ball_table(
    scene: Scene, plan: Plan, geometry: BallBearing, inner: Ellipse, outer: Ellipse, azimuth: np.ndarray
) -> np.ndarray:
    z = len(azimuth)
    centrifugal = 0.0
    if plan.centrifugal:
        cage = geometry.cage_speed(scene.spin_speed)
        centrifugal = geometry.ball_mass(scene.bearing.balls.density) * 0.5 * geometry.pitch_diameter * cage**2
    softness = inner.factor ** (-2.0 / 3.0), outer.factor ** (-2.0 / 3.0)
    share = softness[1] / sum(softness)
    table = np.zeros((z, ring.COLUMNS))
    table[:, ring.COSINE], table[:, ring.SINE] = np.cos(azimuth), np.sin(azimuth)
    table[:, ring.CENTRIFUGAL], table[:, ring.OUTER_SHARE], table[:, ring.OUTER_FACTOR] = centrifugal, share, outer.factor
    table[:, [ring.SIDE, ring.LEVER]] = np.repeat(scene.bearing.rows, geometry.ball_count, axis=0)
    return table


def _linear_parts(scene: Scene, plan: Plan) -> dict[str, np.ndarray]:
    rotor = scene.rotor
    mass, tilt = ring_inertia(scene)
    translation, rotation = rotor.mass + mass, rotor.transverse_inertia + tilt
    damping = np.diag([rotor.damping] * 3 + [0.0, 0.0])
    # dH/dt of a spinning rotor: +I_p W tilt_z' about y, -I_p W tilt_y' about z.
    damping[3, 4] = rotor.polar_inertia * scene.spin_speed
    damping[4, 3] = -damping[3, 4]
    shaft = scene.supports.tilt if isinstance(scene.supports.tilt, float) else 0.0
    return {
        "mass": np.diag([translation] * 3 + [rotation] * 2),
        "damping": damping,
        "stiffness": np.diag([0.0, 0.0, 0.0, shaft, shaft]),
        "free": np.array(plan.free, dtype=float),
    }


def _excitation(scene: Scene) -> dict[str, Any]:
    if scene.excitation is None:
        from raceway.core.excitations.harmonic import no_force

        return {"force": no_force, "force_params": np.zeros(1)}
    parameters = _made_by(f"excitation '{scene.excitation.name}'", "parameters()", scene.excitation.parameters)
    if parameters.ndim != 1:
        raise PluginError(
            f"excitation '{scene.excitation.name}': parameters() returned shape {parameters.shape}; it must be (k,)"
        )
    return {"force": plugin_kernel(scene.excitation, "excitation", FORCE, "FORCE"), "force_params": parameters}


def _first_guess(scene: Scene, geometry: BallBearing, x: float) -> np.ndarray:
    guess = np.zeros(5)
    axial, radial = scene.load.axial, np.array(scene.load.radial)
    rest_axial, rest_radial = geometry.rest
    size = float(np.hypot(*radial))
    if axial > 0.0:
        guess[0] = x
    elif axial < 0.0:
        guess[0] = -2.0 * rest_axial - x
    elif size > 0.0:
        guess[0] = -rest_axial
        guess[1:3] = radial / size * (geometry.centre_distance - rest_radial + 1e-3 * geometry.centre_distance)
    return guess
