"""From scene and plan to arrays and kernels, and to the static equilibrium."""

from __future__ import annotations

from math import pi, radians
from typing import Any

import attrs
import numpy as np

from raceway.contracts import ContactPairs
from raceway.core.bodies.ring import SCALARS
from raceway.core.geometry import BallBearing
from raceway.core.hertz import Ellipse, contact_modulus
from raceway.core.plugin_kernel import plugin_kernel
from raceway.core.signatures import FORCE, LAW
from raceway.core.system import COORDINATES, System
from raceway.errors import ConvergenceError, PluginError
from raceway.estimate import axial_approach
from raceway.plan import Plan
from raceway.ring import ring_inertia, shoulder_height
from raceway.scene import Scene


@attrs.frozen(eq=False)
class Model:
    """Everything that a run computes with.

    Attributes
    ----------
    geometry : lengths of the row;  inner, outer : load-independent Hertz contacts
    azimuth : (Z,) [rad];  guess : (5,) first guess of the equilibrium, with a held axial displacement
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
    azimuth = radians(b.first_ball_azimuth_deg) + 2.0 * pi * np.arange(b.ball_count) / b.ball_count
    scalars = np.zeros(SCALARS)
    arm = geometry.inner_centre_radius if b.tilt_arm == "groove" else 0.5 * b.pitch_diameter
    scalars[:6] = *geometry.rest, geometry.offset_inner, geometry.offset_outer, arm, scene.contact.damping
    x, ball_load = axial_approach(scene)
    system = System(
        kernel=_bodies_kernel(plan),
        law=plugin_kernel(scene.contact.law, "contact law", LAW, "LAW"),
        law_params=_law_params(scene, inner, outer, modulus, max(ball_load, 1.0)),
        law_state=np.zeros((2 * b.ball_count, scene.contact.law.state_size)),
        scalars=scalars,
        table=_ball_table(scene, plan, geometry, inner, outer, azimuth),
        **_linear_parts(scene, plan),
        load=np.array([scene.load.axial, *scene.load.radial, *scene.load.moment]),
        **_excitation(scene),
    )
    guess = _first_guess(scene, geometry, x)
    if scene.supports.axial == "displacement":
        alone = attrs.evolve(system, load=np.array([scene.load.axial, 0, 0, 0, 0.0]), free=np.array([1.0, 0, 0, 0, 0]))
        guess[1:] = 0.0
        guess = alone.settle(guess)[0]
    return Model(scene, plan, geometry, inner, outer, azimuth, system, guess)


def _bodies_kernel(plan: Plan) -> Any:
    if plan.balls == "inertial":
        from raceway.core.bodies.rigid_inertial import rigid_inertial

        return rigid_inertial
    from raceway.core.bodies.rigid_weightless import rigid_weightless

    return rigid_weightless


def _law_params(scene: Scene, inner: Ellipse, outer: Ellipse, modulus: float, ball_load: float) -> np.ndarray:
    z = scene.bearing.ball_count

    def both(a: float, b: float) -> np.ndarray:
        return np.repeat([a, b], z).astype(float)

    pairs = ContactPairs(
        curvature_a=both(inner.curvatures[0], outer.curvatures[0]),
        curvature_b=both(inner.curvatures[1], outer.curvatures[1]),
        contact_modulus=both(modulus, modulus),
        hertz_factor=both(inner.factor, outer.factor),
        reference_load=both(ball_load, ball_load),
    )
    params = np.ascontiguousarray(scene.contact.law.build(pairs), dtype=float)
    if params.ndim != 2 or len(params) != 2 * z:
        raise PluginError(
            f"contact law '{scene.contact.kind}': build() returned parameters of shape {params.shape}; "
            f"it must be ({2 * z}, k): a row for each ball-race pair"
        )
    return params


def _ball_table(
    scene: Scene, plan: Plan, geometry: BallBearing, inner: Ellipse, outer: Ellipse, azimuth: np.ndarray
) -> np.ndarray:
    z = geometry.ball_count
    centrifugal = 0.0
    if plan.balls == "inertial":
        cage = geometry.cage_speed(scene.spin_speed)
        centrifugal = geometry.ball_mass(scene.bearing.balls.density) * 0.5 * geometry.pitch_diameter * cage**2
    softness = inner.factor ** (-2.0 / 3.0), outer.factor ** (-2.0 / 3.0)
    share = softness[1] / sum(softness)
    columns = np.cos(azimuth), np.sin(azimuth), *(np.full(z, v) for v in (centrifugal, share, outer.factor))
    return np.ascontiguousarray(np.column_stack(columns))


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
    parameters = np.ascontiguousarray(scene.excitation.parameters(), dtype=float)
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


@attrs.frozen(eq=False)
class Equilibrium:
    """The static state under the constant loads.

    Attributes
    ----------
    displacement : (5,) x, y, z [m], tilts [rad];  stiffness : (5, 5) tangent of the contacts
    ball : (Z, 2) positions in the meridian planes [m]
    gap, contact_force : (2 Z,) inner races first [m, N]
    angle_inner, angle_outer : (Z,) contact angles [rad], nan where a contact is open
    warnings : what a user should know
    """

    displacement: np.ndarray
    stiffness: np.ndarray
    ball: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    angle_inner: np.ndarray
    angle_outer: np.ndarray
    iterations: int
    warnings: tuple[str, ...]


def settle(model: Model) -> Equilibrium:
    """The static equilibrium of a model.

    Raises
    ------
    ConvergenceError
        None found, or a motion that nothing holds (named).
    """
    system = model.system
    _refuse_no_load(model)
    q, ball, iterations = system.settle(model.guess)
    now = system.evaluate(q, ball=ball)
    _refuse_free_motion(model, now.stiffness, q)
    inner, outer = contact_angles(model, q, now.ball, now.contact_force)
    warnings = _warnings(model, inner, outer, now.contact_force)
    return Equilibrium(q, now.stiffness, now.ball, now.gap, now.contact_force, inner, outer, iterations, warnings)


def contact_angles(model: Model, q: np.ndarray, ball: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (Z,) [rad]; nan where the contact carries nothing."""
    z, scalars = model.geometry.ball_count, model.system.scalars
    c, s = np.cos(model.azimuth), np.sin(model.azimuth)
    axial = scalars[0] + q[0] + scalars[4] * (q[3] * s - q[4] * c)
    radial = scalars[1] + q[1] * c + q[2] * s
    if model.plan.balls == "weightless":
        inner = outer = np.arctan2(axial, radial)
    else:
        inner = np.arctan2(axial - ball[:, 0], radial - ball[:, 1])
        outer = np.arctan2(ball[:, 0], ball[:, 1])
    return np.where(force[:z] > 0, inner, np.nan), np.where(force[z:] > 0, outer, np.nan)


def _refuse_no_load(model: Model) -> None:
    if not np.any(model.system.load * model.system.free) and model.system.free[0] > 0.0:
        raise ConvergenceError(
            "nothing loads the bearing: every motion is free and there is no stiffness to find. Set `load.axial`, or hold "
            'the ring with supports.axial = "displacement" under an axial load.'
        )


def _refuse_free_motion(model: Model, stiffness: np.ndarray, q: np.ndarray) -> None:
    system = model.system
    chosen = np.flatnonzero(system.free > 0.0)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])[chosen]
    scaled = weight[:, None] * system.reduced(stiffness + system.stiffness) * weight
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    if values[-1] > 0.0 and values[0] > 1e-12 * values[-1]:
        return
    motion = np.abs(vectors[:, 0])
    names = [COORDINATES[chosen[k]] for k in np.argsort(-motion) if motion[k] > 0.3 * motion.max()]
    raise ConvergenceError(
        f"the equilibrium is singular: nothing holds the ring against {' with '.join(names)}. Hold it "
        f"({'supports.tilt' if names[0].startswith('tilt') else 'an axial load'}) or load more balls.",
        {"q": q},
    )


def _warnings(model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[str, ...]:
    found = []
    z, d = model.geometry.ball_count, model.geometry.ball_diameter
    if model.geometry.contact_angle > 0.0 and model.scene.load.axial != 0.0 and np.nanmin(inner, initial=np.inf) <= 0.0:
        found.append("the bearing unseats: the contact angle of a loaded ball is zero or negative")
    depth = shoulder_height(model.scene)
    edge = np.arccos(1.0 - depth / (0.5 * d))
    for race, ellipse, angle, load in (
        ("inner", model.inner, inner, force[:z]),
        ("outer", model.outer, outer, force[z:]),
    ):
        half = ellipse.semi_axes(load)[0] / (0.5 * d)
        reach = np.nanmax(np.abs(angle) + half, initial=0.0)
        if reach > edge:
            assumed = "" if model.scene.bearing.shoulder_height else ", assumed 0.2 D"
            found.append(
                f"the contact ellipse on the {race} race reaches {np.degrees(reach):.1f} deg, beyond the groove's edge at "
                f"{np.degrees(edge):.1f} deg (bearing.shoulder_height = {depth:.3g} m{assumed}): it is cut off there in "
                "reality"
            )
    return tuple(found)
