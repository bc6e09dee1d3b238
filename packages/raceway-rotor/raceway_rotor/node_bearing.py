"""A bearing at the node of a rotor: Z of small motions, motion under a load, force of a displacement, secant stiffness of a motion.

Independent of ROSS; x is the bearing's axis.
"""

from math import pi

import attrs
import numpy as np

from raceway import ConvergenceError, Scene, SceneError, build_model
from raceway.extend import (
    Equilibrium, Identifying, Integration, Model, Rotor, SceneSource, as_scene, default_registry, evaluate_following,
    harmonic_load, simulate, solve_equilibrium,
)  # fmt: skip

#: Below this the derivative of Z by j w stands for C [rad/s].
_SLOW = 1e-3
_MOST, _TOLERANCE = 50, 1e-10


@attrs.frozen(eq=False)
class NodeBearing:
    """One bearing under a rotor.

    The node shares x, y, z with the ring, and its tilts where ``tilts`` says so.  ``supports.axial`` decides about x: under
    "force" the axial load is constant (a spring), the ring has its equilibrium on it, and kxx is a spring of the node beside
    the bearing; under "displacement" (spacers) the ring is the node's along x, too, and its load follows from the motion.
    """

    scene: Scene  # static
    tilts: bool = False  # whether the node's own tilts are the ring's
    damping: float = 0.0  # added to all translations [N s/m]
    _equilibria: dict[float, tuple[Model, Equilibrium]] = attrs.field(factory=dict, init=False, repr=False)

    def __deepcopy__(self, _memo: object) -> "NodeBearing":
        """Itself: it never changes, and ROSS copies rotors."""
        return self

    @property
    def size(self) -> int:
        """Coordinates of the node that K and C are given over: x, y, z, and the tilts about y and z."""
        return 5 if self.tilts else 3

    @property
    def moving(self) -> list[int]:
        """Coordinates of the synchronous motion: y, z, and tilts."""
        return list(range(1, self.size))

    def _inside(self, model: Model) -> list[int]:
        """Coordinates of the ring with an equilibrium of their own: x on a constant load, tilts that the node does not share."""
        first = [0] if self.scene.supports.axial == "force" else []
        return first + [i for i in range(self.size, 5) if model.system.free[i] > 0.0]

    def at_rest(self, speed: float) -> tuple[Model, Equilibrium]:
        """Model and equilibrium of the ring that turns with a speed [rad/s]."""
        if speed not in self._equilibria:
            self._equilibria.clear()  # calls in a row are for one speed; models of elastic bodies are large
            kinematics = attrs.evolve(self.scene.kinematics, spin_speed_rpm=speed * 30.0 / pi)
            model = build_model(attrs.evolve(self.scene, kinematics=kinematics))
            self._equilibria[speed] = model, solve_equilibrium(model)
        return self._equilibria[speed]

    def dynamic_stiffness(self, frequency: float, speed: float) -> np.ndarray:
        """Z = K + j w C (n, n) of small motions at w = frequency, the ring turning with a speed [rad/s]."""
        w = max(abs(frequency), _SLOW)
        model, equilibrium = self.at_rest(speed)
        system = model.system
        # The ring's gyroscopic moments are the rotor model's, as its mass is.
        viscous = 0.5 * (system.damping + system.damping.T)
        contacts = equilibrium.stiffness + 1j * w * (equilibrium.damping - equilibrium.damping_rows_held)
        contacts += system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, w)
        full = contacts + system.stiffness + 1j * w * viscous
        full[:3, :3] += 1j * w * self.damping * np.eye(3)
        inside = self._inside(model)
        at_node = _schur_complement(full, list(range(self.size)), [i for i in inside if i > 0])
        if 0 in inside:
            at_node[0, 1:] = at_node[1:, 0] = 0.0
            at_node[1:, 1:] = _schur_complement(full, self.moving, inside)
        return at_node

    def motion(self, speed: float, load: np.ndarray) -> np.ndarray:
        """Complex amplitudes of ``moving`` under a synchronous load (n,) on them, without inertia: what the contacts carry.

        ConvergenceError: A load that the bearing cannot carry.
        """
        full = np.zeros(5, dtype=complex)
        full[self.moving] = load
        model = build_model(attrs.evolve(self.at_rest(speed)[0].scene, excitation=harmonic_load(speed, full)))
        record = simulate(model, solve_equilibrium(model)).record
        turning = np.exp(-1j * speed * record.time) * (2.0 / len(record.time))
        return np.asarray(turning @ record.displacement[:, self.moving])

    def stiffness_on(self, speed: float, load: np.ndarray, motion: np.ndarray) -> np.ndarray:
        """Z (n, n) that carries a motion of ``moving`` under its load: the smallest symmetric change of that of small motions."""
        z = self.dynamic_stiffness(speed, speed)
        part = np.ix_(self.moving, self.moving)
        z[part] = secant_stiffness(z[part].real, motion, load, self.units(speed)) + 1j * z[part].imag
        return z

    def units(self, speed: float) -> np.ndarray:
        """Length of a unit of each of ``moving``: 1 for m, for rad the arm of the tilts [m]."""
        arm = self.at_rest(speed)[0].system.arm
        return np.array([1.0, 1.0, arm, arm])[: len(self.moving)]

    def resistance(self, speed: float, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force (n,) against a displacement (n,) of the node from its equilibrium [N, N m], and its derivative (n, n).

        Damping is not in it.

        ConvergenceError: A displacement at which the balls, or free coordinates of the ring, have no equilibrium.
        """
        model, equilibrium = self.at_rest(speed)
        system, inside = model.system, self._inside(model)
        outside = self.moving if 0 in inside else [0, *self.moving]
        q = equilibrium.displacement.copy()
        q[outside] += displacement[outside]
        size = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
        for _ in range(_MOST):
            contacts = evaluate_following(model.problem, system, q, equilibrium.ball)
            residual, tangent = contacts.force + system.stiffness @ q - system.load, contacts.stiffness + system.stiffness
            if not inside or np.abs((residual / size)[inside]).max() <= _TOLERANCE * np.abs(contacts.contact_force).max():
                break
            q[inside] -= np.linalg.solve(tangent[np.ix_(inside, inside)], residual[inside])
        else:
            where = np.array2string(displacement, precision=3)
            raise ConvergenceError(f"the ring has no equilibrium at the node's displacement {where} m")
        force, slope = np.zeros(self.size), np.zeros((self.size, self.size))
        force[outside], slope[np.ix_(outside, outside)] = residual[outside], _schur_complement(tangent, outside, inside)
        if inside:  # the residual of the iteration
            correction = np.linalg.solve(tangent[np.ix_(inside, inside)], residual[inside])
            force[outside] -= tangent[np.ix_(outside, inside)] @ correction
        if 0 in inside:
            still = equilibrium.stiffness + system.stiffness
            beside = _schur_complement(still, list(range(self.size)), [i for i in inside if i > 0])
            slope[0, 0] = beside[0, 0]
            force[0] = slope[0, 0] * displacement[0]
        return force, slope


def _schur_complement(matrix: np.ndarray, outside: list[int], inside: list[int]) -> np.ndarray:
    """Part of a matrix over some coordinates, others free of load."""
    part = matrix[np.ix_(outside, outside)]
    if not inside:
        return np.array(part)
    free = np.linalg.solve(matrix[np.ix_(inside, inside)], matrix[np.ix_(inside, outside)])
    return np.asarray(part - matrix[np.ix_(outside, inside)] @ free)


def node_bearing(
    bearing: SceneSource,
    preload: float | None = None,
    tilt: float | str | None = None,
    axial: str | None = None,
    damping: float = 0.0,
) -> NodeBearing:
    """The bearing of a preset or a scene.

    bearing : name of a preset, or Scene, path, TOML text, dict of tables
    preload : axial load [N]; None: the scene's own
    tilt : "locked", "free", "node" (the node's tilts are the ring's) or a stiffness [N m/rad]; None: the scene's supports.tilt
    axial : "force" or "displacement"; None: the scene's supports.axial;  damping : added to the translations [N s/m]

    SceneError: With every mistake that was found.
    """
    is_preset = isinstance(bearing, str) and not any(sign in bearing for sign in "./\\\n=[")
    scene = as_scene({"bearing": {"preset": bearing}} if is_preset else bearing)
    changes = {"load.axial": preload, "supports.tilt": "free" if tilt == "node" else tilt, "supports.axial": axial}
    scene = as_scene(scene, {key: value for key, value in changes.items() if value is not None})
    if not damping >= 0.0 or not np.isfinite(damping):
        raise SceneError.at("damping", damping, "must be a finite damping of at least 0 N s/m")
    if scene.contact.friction > 0.0:
        rule = "dissipates, which a stiffness does not contain: set it to 0 and use `damping`"
        raise SceneError.at("contact.friction", scene.contact.friction, rule)
    find = default_registry().find
    scene = attrs.evolve(
        scene,
        rotor=Rotor(damping=scene.rotor.damping),
        excitation=None,
        integrator=Integration(kind="quasi_static", method=find("integrator", "quasi_static").plugin()),
        identifier=Identifying(method=find("identifier", "fft_1x").plugin()),
    )
    return NodeBearing(scene, tilt == "node", damping)


def secant_stiffness(tangent: np.ndarray, motion: np.ndarray, load: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Real symmetric (n, n) K with K u = f, nearest to the tangent.

    tangent : (n, n) [N/m, N, N m/rad];  motion, load : (n,) complex amplitudes u, f of one harmonic
    unit : (n,) length of a unit of each coordinate [1 for m, an arm in m for rad], which makes changes comparable

    With U = [Re u, Im u], R = [Re f, Im f] - K_t U and the pseudoinverse U+ the symmetric D of least Frobenius norm with D U = R is

        D = R U+ + (R U+)' - (U+)' U'R U+

    (the symmetric update of Powell for one vector, here for two).  It exists where U'R is symmetric: where the motion takes
    no work from the ring in a turn.  On a circle it is the same change of kyy and kzz, without cross terms; along a line it
    leaves the stiffness across as it was.

    Dennis & Schnabel, Numerical Methods for Unconstrained Optimization and Nonlinear Equations, 1983, section 9.1 and
    Schnabel, Quasi-Newton methods using multiple secant equations, 1983.
    """
    columns = np.column_stack([motion.real, motion.imag]) * unit[:, None]
    residual = np.column_stack([load.real, load.imag]) / unit[:, None] - (tangent / np.outer(unit, unit)) @ columns
    inverse = np.linalg.pinv(columns, rcond=1e-9)
    work = columns.T @ residual
    part = residual @ inverse
    change = part + part.T - inverse.T @ (0.5 * (work + work.T)) @ inverse
    return np.asarray(tangent + change * np.outer(unit, unit))
