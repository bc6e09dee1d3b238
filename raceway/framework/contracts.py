"""Contracts of plug-ins: the duties of each kind, numbered.

A plug-in is a frozen attrs class: its fields are its options (declared with ``raceway.framework.options.option``), its class
attribute ``name`` is the word that a scene writes as ``kind``.  The class is light; ``kernel()`` imports what is
compiled.  These protocols are one level deep: nothing has to inherit from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar, cast

import attrs
import numpy as np

from raceway.core.contact.hertz import ellipticity
from raceway.errors import Mistake
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from pathlib import Path

    import click

    from raceway.core.fem.mesh.hex_mesh import HexMesh
    from raceway.core.jit import Kernel
    from raceway.core.record import Record
    from raceway.core.signals import Identification
    from raceway.core.time.schemes import Scheme


class ContactLaw(attrs.AttrsInstance, Protocol):
    """Normal force of a contact as a function of gap and gap rate.  Damping and friction are the core's.

    1. ``discretisations``: a subset of {"resultant", "nodal"}: what the force means (N a pair, or Pa a point).
    2. ``state_size``: columns of memory a contact; 0 for none.  ``dissipative``: whether a closed cycle loses energy.
    3. ``build(pairs)``: parameters, an array (n, k) of float64, from ``ContactPairs``.
    4. ``kernel()``: a function compiled with ``@jit(LAW)``: zero force for gap >= 0, never negative, monotonic in the
       approach, derivatives exact, inputs untouched, outputs overwritten whole, no allocation.
    5. A law for both discretisations distinguishes them by ``pairs.area``, which is None for resultants.
    6. May be left out, as the rest, with the defaults of ``DEFAULTS``: ``constraint`` = True says that the law stands for
       no penetration at all: condensed bodies then hold the gap exactly and do not call the kernel.
    7. ``foundation`` = True says that a resultant is the integral of a pressure that follows from the overlap at each place: results
       then have the law's own peak pressure and semi-axes, sqrt(A B) / pi dQ/ddelta and the overlap ellipse's, instead of Hertz's
       at the same load.
    8. ``renewed`` = True says that parameters follow the running speed and the loads: ``build`` is called once for the mounted
       bearing at standstill, where ``pairs.entraining_speed`` and ``pairs.load`` are None and the law is dry, and again at the
       running equilibrium until loads and parameters fit each other; again where a run changes the speed.
    9. ``reach(pairs)``, with ``renewed``: how far from touching each contact begins to carry (n,) [m], 0 or more: what stands
       between the surfaces, such as a film.  The bearing makes room for it: the kernel's gap is measured from there.
    10. ``report(pairs)``, with ``renewed``: a ``LawReport`` at the running equilibrium.
    11. ``elementwise`` = True says that options may be arrays (n,), one number for each contact: many operating points whose
        options differ are then built at once, else once for each value.
    12. ``line_contact`` = True says that it is a law of line contacts, of rollers: ``pairs.length`` is their length.
    13. ``hertzian`` = True says that the resultant of a point contact is Hertz's, ``hertz_factor`` times the approach to the 1.5: what
        the calibration of elastic bodies leaves is then an error of the numbers, else of the law.
    """

    name: ClassVar[str]
    discretisations: ClassVar[frozenset[str]]
    state_size: ClassVar[int]
    dissipative: ClassVar[bool]

    def build(self, pairs: ContactPairs) -> np.ndarray: ...
    def kernel(self) -> Kernel: ...


@attrs.frozen(eq=False)
class ContactPairs:
    """Contacts as a law sees them; arrays (n,), inner races first, then outer.

    Attributes
    ----------
    curvature_a, curvature_b : gap = A x^2 + B y^2 [1/m], x along the major semi-axis
    contact_modulus : E* [Pa]
    hertz_factor : K of Q = K delta^1.5 [N/m^1.5]
    reference_load : load of a ball under the axial load alone [N]
    area : area of a surface point [m2], None for resultants; each row then stands for the points of a contact
    length : of a line contact [m], which has A = 0 and no Hertz factor (nan); None where contacts are ellipses
    ring_young, ring_poisson, ball_young, ball_poisson : materials [Pa]; None where bodies have none
    running_angle : of the running direction against the minor semi-axis [rad]; 0 in ball bearings
    entraining_speed : mean speed of both surfaces against the contact, along the running direction [m/s], from the kinematics at
        the running speed and the loaded contact angles; None at standstill
    load : in the running equilibrium [N], at least a tenth of the most loaded contact's of its race and row: that of a contact
        which is about to carry; of balls that orbit the mean of their race and row; None at standstill
    """

    curvature_a: np.ndarray
    curvature_b: np.ndarray
    contact_modulus: np.ndarray
    hertz_factor: np.ndarray
    reference_load: np.ndarray
    area: np.ndarray | None = None
    length: np.ndarray | None = None
    ring_young: np.ndarray | None = None
    ring_poisson: np.ndarray | None = None
    ball_young: np.ndarray | None = None
    ball_poisson: np.ndarray | None = None
    running_angle: np.ndarray | None = None
    entraining_speed: np.ndarray | None = None
    load: np.ndarray | None = None

    def at(self, contacts: np.ndarray) -> ContactPairs:
        """Some of the contacts, by their indices (m,)."""
        arrays = {name: array for name, array in attrs.asdict(self, recurse=False).items() if array is not None}
        return attrs.evolve(self, **{name: array[contacts] for name, array in arrays.items()})

    @property
    def radius_along(self) -> np.ndarray:
        """(n,) effective radius along the running direction [m]: 1 / (2 B) of balls that roll along the minor semi-axis."""
        return self._radius(0.0)

    @property
    def radius_across(self) -> np.ndarray:
        """(n,) effective radius across the running direction [m]."""
        return self._radius(0.5 * math.pi)

    def _radius(self, further: float) -> np.ndarray:
        angle = further + (0.0 if self.running_angle is None else self.running_angle)
        across, along = np.sin(angle) ** 2, np.cos(angle) ** 2
        return np.asarray(0.5 / (self.curvature_b * along + self.curvature_a * across))

    @property
    def ellipticity(self) -> np.ndarray:
        """(n,) a / b of the contact ellipse, from the complete elliptic integrals."""
        difference = (self.curvature_b - self.curvature_a) / (self.curvature_b + self.curvature_a)
        values, position = np.unique(difference, return_inverse=True)
        return np.array([ellipticity(float(value)) for value in values])[position]


@attrs.frozen(eq=False)
class LawReport:
    """What a law reports of the contacts in the running equilibrium.

    Attributes
    ----------
    columns : name -> (n,) numbers or words, to ``equilibrium.balls[]`` of result.json, with ``inner_`` and ``outer_`` before
    table : name -> number of all contacts, to ``equilibrium.law``
    warnings : what a user should know
    """

    columns: Mapping[str, np.ndarray]
    table: Mapping[str, float | str | None]
    warnings: tuple[str, ...] = ()


class Excitation(attrs.AttrsInstance, Protocol):
    """A force on the inner ring's reference point as a function of time.

    1. ``frequency_hz``, ``period_s``, ``amplitude_n``: the fundamental line; ``period_s`` None when not periodic.
    2. ``sense``: +1 turns forward (from +y towards +z), -1 backward, 0 along a fixed direction.
    3. ``parameters()``: an array (k,) of float64 that the kernel gets.
    4. ``kernel()``: a function compiled with ``@jit(FORCE)`` that overwrites out (5,) = F_x, F_y, F_z, M_y, M_z.
    5. May be left out, with the defaults of ``DEFAULTS``: ``speed_rpm``, the default of
       ``kinematics.spin_speed_rpm``; ``first_speed_rpm``, from which the speed changes to ``speed_rpm``; ``ramp_turns``, the time over
       which the core lets the force grow; ``duration_s``, the time that is integrated, instead of ``integrator.turns``;
       ``phase(time)``, the angle of the 1x component (n,) [rad], which identifiers of changing speeds need, and without a period the
       angle that the spin speed follows; ``steady()``, a periodic excitation whose orbit the motion starts on;
       ``at_whirl(speed_rpm)``, the same force at another whirl speed, for identifiers of several speeds: else they change
       ``speed_rpm``; ``elementwise`` = True: options may be arrays (n,), of many operating points, which ``parameters()`` answers with
       (n, k) and ``period_s`` with (n,); points with different options are else asked one by one.
    """

    name: ClassVar[str]

    @property
    def frequency_hz(self) -> float: ...
    @property
    def period_s(self) -> float | None: ...
    @property
    def amplitude_n(self) -> float: ...
    @property
    def sense(self) -> int: ...
    def parameters(self) -> np.ndarray: ...
    def kernel(self) -> Kernel: ...


class Integrator(attrs.AttrsInstance, Protocol):
    """A way through time.

    1. ``order``: the exponent of the step in the error, for smooth motions.
    2. ``implicit``: whether steps above ``System.critical_time_step`` are allowed.  ``inertial``: whether the motion
       contains inertia forces (K = Re Z + m w^2) or is a series of equilibria.
    3. ``dissipative``: whether the method removes energy by itself.  ``steady``: whether the method solves for the motion that
       repeats itself every turn of the schedule, whatever it starts from; ``counts["error"]`` is
       the error of its displacement over the amplitude, ``counts["floquet"]``, if there is one, goes to result.json,
       ``counts["orbits"]``, a list of all steady motions that were found, to its ``motion.orbits``, and a scene that has no
       such motion is refused with a ``SceneError``.
    4. ``scheme``: ``OneStep``, ``Explicit`` or ``Static`` of ``raceway.core.time.schemes`` by their numbers, which run on every kind of
       bodies; or ``Drivers`` of the method's own.  ``compiled(system, start, schedule, on_chunk)`` takes the steps of a ring
       whose forces are compiled and returns a ``Record``; it calls ``on_chunk(done, total)`` now and then, whose exceptions
       pass through.  ``stepped(system, recorder)`` takes those of any ``SteppedSystem``, each handed to
       ``recorder.accept``; where ``compiled`` is left out, of compiled rings too.  A plan refuses bodies for which the driver is
       missing.  On failure they raise ``ConvergenceError`` or ``StabilityError`` with the last good state.
    5. ``start.near``, if it is not None, is the ``solution`` that the same integrator left in the record of a similar motion:
       it may be started from, and must not change the answer beyond the method's tolerance; unless ``start.stay`` asks for
       the continuation of that motion where several exist.
    6. May be left out: ``orbit`` = True says of a ``steady`` method that its motion is the steady orbit, to its stated error,
       however it finds it: many points are then solved for by compiled loops, not by its driver.
    7. May be left out: ``device`` = "gpu" asks for a CUDA device, "auto" for one where the bodies' steps can be taken there.
    """

    name: ClassVar[str]
    order: ClassVar[int]
    implicit: ClassVar[bool]
    inertial: ClassVar[bool]
    dissipative: ClassVar[bool]
    steady: ClassVar[bool]

    @property
    def scheme(self) -> Scheme: ...


class Identifier(attrs.AttrsInstance, Protocol):
    """From recorded motion, or from the equilibrium, to a dynamic stiffness.

    1. ``needs``: a subset of {"record", "speeds", "equilibrium", "period", "phase"}: recorded motion; a record for each
       of its option ``speeds_rpm``; the equilibrium alone; an excitation at one frequency (not a run-up); an
       excitation that knows its phase.
    2. ``definition``: one sentence: secant or tangent, of which signals.
    3. ``identify(records, equilibrium, model)``: an ``Identification``; ``model`` offers ``mass_used``,
       ``excitation``, ``scene`` and ``system``.
    4. Where ``series`` holds several speeds of one record, ``series_error`` may hold the relative error of each Z; of a changing
       speed it is replaced by the distance from the steady motion where that can be solved for.
    5. An option ``harmonics``, if there is one, is how many multiples of the frequency are fitted with mean and drift: the plan
       refuses more than the samples of a turn determine.
    6. May be left out: ``synchronous`` = True says that Z of a steady motion is F^H F / F^H x of the synchronous (1x) components of
       force and displacement: compiled loops over many points then state it.
    """

    name: ClassVar[str]
    needs: ClassVar[frozenset[str]]
    definition: ClassVar[str]

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification: ...


class Equilibrium(Protocol):
    """The static state as identifiers see it: of the ring displacement (5,) [m, rad] and tangent stiffness (5, 5), of the balls (Z, 2) [m]."""

    @property
    def displacement(self) -> np.ndarray: ...
    @property
    def stiffness(self) -> np.ndarray: ...
    @property
    def stiffness_rows_held(self) -> np.ndarray: ...
    @property
    def ball(self) -> np.ndarray: ...


class Model(Protocol):
    """What moved, as identifiers see it: the scene, its excitation, the system that was integrated, the mass of K = Re Z + m w^2 [kg]."""

    @property
    def scene(self) -> Any: ...
    @property
    def excitation(self) -> Any: ...
    @property
    def system(self) -> Any: ...
    @property
    def mass_used(self) -> float: ...


class Mesher(attrs.AttrsInstance, Protocol):
    """Bodies to hexahedra.

    1. ``mesh(bearing)``: body -> mesh with ``points`` (n, 3) [m] and ``cells`` (m, 8) in VTK's order, best a
       ``raceway.core.fem.mesh.hex_mesh.HexMesh`` with sets; ``bearing`` is the scene's [bearing] table.  Names of bodies:
       ``inner_ring``, ``outer_ring``, ``ball_0`` and so on; a set of facets on the groove is called ``raceway``, on the
       bore or the outer cylinder ``seat``, on a contact of a ball ``inner_patch`` and ``outer_patch``.
    2. No cell is inverted or flat; what cannot be meshed raises ``MeshError``.
    3. The same bearing gives the same mesh.
    4. An option ``ball_load`` that is None gets the static load of a ball [N] from the scene.
    5. Optional ``predict(bearing)``: body -> number of cells, without meshing, for the plan (or a
       ``raceway.core.fem.mesh.quality.Prediction``; None: unknown); what cannot be meshed raises ``MeshError`` here
       already.  It executes nothing, starts no process and writes no file: ``raceway check`` calls it on foreign scenes.
    6. May be left out: ``swept`` = True says that rings are swept from their sections, in as many equal sectors as there are balls.
    """

    name: ClassVar[str]

    def mesh(self, bearing: Any) -> Mapping[str, HexMesh]: ...


class Format(attrs.AttrsInstance, Protocol):
    """A file format: of meshes (``HexMesh``), of anything else, or of results.

    1. ``suffixes``: file endings with the dot.
    2. ``read(path)``.  ``write(path, content)``, which a format that only reads leaves out: what is written is read back the same, sets
       too, real numbers at least to ten figures.
    3. A file that is missing or malformed raises a ``RacewayError`` that names it.
    4. ``of_results`` = True, else left out: ``write(folder, result)`` writes files of a ``Result`` into a folder and returns their
       paths (``raceway run --report NAME``); such a format may leave ``read`` out.
    """

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]

    def read(self, path: Path) -> Any: ...
    def write(self, path: Path, content: Any) -> list[Path] | None: ...


_T = TypeVar("_T")


class Problem(Protocol):
    """What is computed as quantities see it: tables of the scene by their names, and what follows from them.

    Where ``points`` is (n,) numbers are columns of n operating points; ``spin_speed`` [rad/s] is the inner ring's, ``ratings`` are each row's.
    """

    @property
    def scene(self) -> Any: ...
    @property
    def bearing(self) -> Any: ...
    @property
    def bodies(self) -> Any: ...
    @property
    def mesh(self) -> Any: ...
    @property
    def load(self) -> Any: ...
    @property
    def contact(self) -> Any: ...
    @property
    def excitation(self) -> Any: ...
    @property
    def kinematics(self) -> Any: ...
    @property
    def lubricant(self) -> Any: ...
    @property
    def heat(self) -> Any: ...
    @property
    def quantities(self) -> Any: ...
    @property
    def points(self) -> tuple[int, ...]: ...
    @property
    def spin_speed(self) -> Any: ...
    @property
    def ratings(self) -> tuple[Any, ...]: ...
    @property
    def traits(self) -> Traits: ...


@attrs.frozen(eq=False, slots=False)
class SolvedPoints:
    """n solved operating points as quantities see them; Z balls of all rows; race 0 is the inner, 1 the outer one.

    Attributes
    ----------
    problem : its continuous numbers are scalars, or columns (n,)
    row : (Z,) row of each ball;  side : (Z,) +1 where its outer race takes an axial force along +x, else -1
    speed : (n,) of the shaft [rad/s]
    load : (n, 2, Z) contact forces under the constant loads [N], 0 where a contact is open
    contact_angles : (n, 2, Z) under them [rad], nan where a contact is open
    displacement, stiffness : (n, 5), (n, 5, 5) of the inner ring [m, rad; N/m, N/rad, N m/m, N m/rad]
    running_contacts : all contacts (n 2 Z,) one after the other as a contact law sees them at the running speed
    ellipse : of contact forces (n, 2, Z) peak pressure [Pa], major and minor semi-axis [m], each (n, 2, Z)
    turn : of a number T contact forces (n, T, 2, Z) at T equidistant times of a turn of the motion, from phase 0 of the force on [N];
        None without a motion
    """

    problem: Problem
    row: np.ndarray
    side: np.ndarray
    speed: np.ndarray
    load: np.ndarray
    contact_angles: Callable[[], np.ndarray]
    displacement: np.ndarray
    stiffness: np.ndarray
    running_contacts: Callable[[], ContactPairs]
    ellipse: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    turn: Callable[[int], np.ndarray] | None = None

    @cached_property
    def contact_angle(self) -> np.ndarray:
        """(n, 2, Z) under ``load`` [rad], nan where a contact is open."""
        return self.contact_angles()

    @cached_property
    def semi_axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Major and minor semi-axes of the contacts under ``load`` (n, 2, Z) [m]."""
        return self._ellipses[1:]

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(n, 2, Z) under ``load`` [Pa]."""
        return self._ellipses[0]

    def once(self, name: str, compute: Callable[[], _T]) -> _T:
        """What several duties of plug-ins need of these points, computed when it is first asked for by its name."""
        if name not in self._computed:
            self._computed[name] = compute()
        return cast("_T", self._computed[name])

    @cached_property
    def _computed(self) -> dict[str, object]:
        return {}

    @cached_property
    def _ellipses(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.ellipse(self.load)


class Quantities(attrs.AttrsInstance, Protocol):
    """Numbers of a solved point; its options are the keys of the table [quantities.NAME], which all have defaults.

    1. ``numbers``: a ``raceway.answers.quantities.Quantity`` for each, whose ``path`` begins with the plug-in's name: NAME.KEY is its place
       in result.json.  They are outputs of functions, columns of sweeps, numbers of bands and of fits by their names, which no other
       quantity has; short tables show the first.
    2. ``why_not(problem)``: what a scene lacks for them, with the keys; empty where it has all.  They are left out then.
    3. ``compute(points)``: name -> numbers (n,), or arrays (n, ...) over the quantity's ``dims``, of ``SolvedPoints``: what follows for
       one point follows for columns.  Points are not changed.
    4. May be left out: ``table(points, values)``: of one point, what result.json has at NAME, plain values; else the numbers.
    5. May be left out: ``warnings(points, values)``: of one point, what a user should know, sentences.
    6. May be left out: ``turn_samples(problem)``: T, for how many times of a turn ``compute`` calls ``points.turn(T)``; else no forces
       along a motion are there in columns.
    7. May be left out: ``rows(table)``, a static method: of what result.json has at NAME rows of the screen, each name, value with unit,
       and remark; a row without a value is a heading.  Else the class's first line and its numbers.
    """

    name: ClassVar[str]
    numbers: ClassVar[tuple[Any, ...]]

    def why_not(self, problem: Problem) -> str: ...
    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]: ...


#: A batch of a study: its number, and what is computed in it as plain values.
Batch = tuple[int, list[Any]]
#: Number of a batch, and what the work returned for it, or ``Refused``, or ``Lost``.
Answer = tuple[int, Any]


class Work(Protocol):
    """What an executor computes with: duty 2 of ``Executor``."""

    def fault(self) -> str | None: ...
    def __call__(self, points: list[Any], /) -> Any: ...


@attrs.frozen
class Refused:
    """Answer of a worker that is not fit for the work: another version, a plug-in that it lacks."""

    worker: str
    reason: str


@attrs.frozen
class Lost:
    """Answer for a batch that was given up: its workers died."""

    reason: str


class Executor(attrs.AttrsInstance, Protocol):
    """Where the runs of a study are computed: in this process, in others, on other machines.

    1. ``compute(work, batches)`` yields ``(number, answer)`` for every ``(number, points)`` of ``batches``, each as soon as
       it is there, in any order; ``answer`` is what ``work(points)`` returned.
    2. ``work`` can be pickled and called anywhere; it answers for numerical failures itself, and what else it raises passes
       through.  ``work.fault()`` says in words why the process that it is called in is not fit for it, or None; such a
       process answers ``Refused``, which an executor with other workers may give to those and else passes on.
    3. ``batches`` is an iterable that is taken from as workers get free, a few for each of them: studies are long.
    4. A batch whose worker died is computed again; one that is given up is answered with ``Lost``.
    5. Closing the iterator (Ctrl-C, an error) stops what is in flight and leaves no process behind.
    6. Options ``workers`` and ``scheduler``, if there are any, are what ``raceway sweep --workers --scheduler`` give.
       A package that is missing, or a scheduler that does not answer, is a ``PluginError`` before a batch is taken.
    """

    name: ClassVar[str]

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]: ...


@attrs.frozen
class Traits:
    """What a plan and an error estimate must know of bodies in a scene.

    Attributes
    ----------
    compiled : contact forces are compiled: methods with a compiled driver run, and steady orbits are searched for
    resultants : one force a contact, whose energy and pressure follow from its gap
    calibrated : what the contacts' calibration leaves is part of the total error
    every_node : all nodes are unknowns: a second run to compare with would cost as much as the first
    renews : parameters of contact laws are renewed at the running speed and equilibrium (``ContactLaw``, duty 8)
    line_contacts : contacts are lines of rollers: numbers of point contacts, as lives, films and friction torques, are not computed
    damps : contacts have dashpots in proportion to their stiffness (``Problem.time_constant``)
    contacts_alone : nothing but point contacts deforms, each by its own gap, and runs state no error of the bodies: sweeps and
        derivatives need no runs for it
    """

    compiled: bool = True
    resultants: bool = True
    calibrated: bool = False
    every_node: bool = False
    renews: bool = False
    damps: bool = False
    line_contacts: bool = False
    contacts_alone: bool = False


@attrs.frozen
class Cost:
    """Predictions for a run, on the machine whose times the program knows.

    Attributes
    ----------
    seconds : of processor time, kernels compiled, of the bodies nothing cached
    once : seconds of it that a second run on the same bodies does not take again
    unknowns : None for those of the ring and the balls alone
    mesh : ``bodies[{name, cells, bytes}]``, ``cells``, ``bytes``; None where nothing is meshed or predicted
    scales : whether a slower machine takes longer in proportion
    at_least : whether it may be any number of times more: a mesh whose size is not known before it is read
    bytes : resident memory of the process at the peak; 0 where it is small, or not known
    """

    seconds: float
    once: float = 0.0
    unknowns: int | None = None
    mesh: Tables | None = None
    scales: bool = True
    at_least: bool = False
    bytes: int = 0


class BodiesKind(attrs.AttrsInstance, Protocol):
    """What rings and balls are made of: what deforms, and how the ring follows its loads.

    1. ``faults(problem)``: mistakes of the scene that these bodies cannot run, each with the remedy; nothing is built.  A
        ``Problem`` of ``raceway.planning.resolve`` has the tables of the scene, and what follows from them.
    2. ``traits(problem)``: ``Traits``.
    3. ``stable_step(problem)``: rough stable limit of explicit steps [s]; None where nothing is known.
    4. ``decide(problem, parts)``: the bodies' own parts, each included or left out with its reason (``raceway.planning.parts``).
    5. ``cost(problem, balls, motion, parts)``: ``Cost``, by what was decided for the balls and the motion.
    6. ``build(problem, plan)``: a ``BuiltBearing`` of ``raceway.extend``: arrays and kernels, no equilibrium yet.
    7. The fields of the class are the keys of the table [bodies] beside ``kind``.
    8. May be left out: ``unused(tables)``: (key, reason) for each key of a scene's tables that changes nothing with these bodies.
    9. May be left out: ``example_scene()``, a classmethod: the tables of a small scene, less [bodies], that these bodies run,
        for the suite; else that is a ball bearing of 30 mm bore under axial and radial load.
    10. May be left out: ``same_bodies(problem, changed)``: whether nothing that is meshed differs between two of this kind, so
        that a difference of their results is a derivative; else [bearing] decides where there is a [mesh].
    11. May be left out: ``columns(problem, plan)``: a ``raceway.bodies.columns.ColumnBearing``, the bearing at the n points of a
        problem whose numbers are columns: what compiled loops over many points take.  Else each point is a run.  A class that
        overrides ``build`` gives its own, as traits of laws, integrators and identifiers are said anew where a duty is overridden.
    12. May be left out, beside it: ``why_no_columns(problem, key)``: why ``key``, or with None anything, can be no column, in words;
        empty where it can.
    13. May be left out: ``rollers`` = True says that these bodies roll on rollers: screens call them so, else balls.
    """

    name: ClassVar[str]

    def faults(self, problem: Any) -> list[Mistake]: ...
    def traits(self, problem: Any) -> Traits: ...
    def stable_step(self, problem: Any) -> float | None: ...
    def decide(self, problem: Any, parts: Any) -> None: ...
    def cost(self, problem: Any, balls: Any, motion: Any, parts: Any) -> Cost: ...
    def build(self, problem: Any, plan: Any) -> Any: ...


class Study(attrs.AttrsInstance, Protocol):
    """Many runs made into one answer: the command ``raceway study NAME``.

    1. ``help``: what it is about, one line.
    2. ``command()``: a ``click.Command`` whose name is ``name``, with ``--json``; it is imported here, and numba, scipy or
       matplotlib not before it runs.  It returns its exit code: 0, or 1 where numbers failed.
    3. Mistakes are ``RacewayError``; Ctrl-C passes through.  ``raceway.points.engine`` keeps what is finished.
    """

    name: ClassVar[str]
    help: ClassVar[str]

    def command(self) -> click.Command: ...


#: kind -> (registration hook, what a class of that kind must have)
KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "contact_law": ("raceway_contact_laws", ("discretisations", "state_size", "dissipative", "build", "kernel")),
    "excitation": ("raceway_excitations", ("frequency_hz", "period_s", "amplitude_n", "sense", "parameters", "kernel")),
    "integrator": ("raceway_integrators", ("order", "implicit", "inertial", "dissipative", "steady", "scheme")),
    "identifier": ("raceway_identifiers", ("needs", "definition", "identify")),
    "mesher": ("raceway_meshers", ("mesh",)),
    "format": ("raceway_formats", ("suffixes",)),
    "bodies": ("raceway_bodies", ("faults", "traits", "stable_step", "decide", "cost", "build")),
    "quantity": ("raceway_quantities", ("numbers", "why_not", "compute")),
    "executor": ("raceway_executors", ("compute",)),
    "study": ("raceway_studies", ("help", "command")),
}

#: What a class may leave out -> its default; of a duty None, where its caller says what holds then.
DEFAULTS: dict[str, Any] = {
    **dict.fromkeys(("renewed", "line_contact", "constraint", "foundation", "elementwise", "hertzian"), False),
    **dict.fromkeys(("swept", "of_results", "orbit", "synchronous", "columns", "rollers"), False),
    **dict.fromkeys(("reach", "report"), None),  # of contact laws
    **dict.fromkeys(("speed_rpm", "first_speed_rpm", "duration_s", "phase", "steady", "at_whirl"), None),  # of excitations
    "ramp_turns": 0.0,
    **dict.fromkeys(("unused", "same_bodies", "why_no_columns"), None),  # of bodies
    **dict.fromkeys(("rows", "turn_samples", "table", "warnings"), None),  # of quantities
    "device": "cpu",  # of integrators
}


def said(plugin: object, name: str) -> Any:
    """What a plug-in says under a name that it may leave out, or the default; that, too, where there is no plug-in."""
    return getattr(plugin, name, DEFAULTS[name])


def plural(kind: str) -> str:
    """A kind of plug-ins in words: "contact laws"."""
    words = kind.replace("_", " ")
    if words.endswith("s"):
        return words
    return f"{words.removesuffix('y')}ies" if words.endswith("y") else f"{words}s"


def broken_duties(kind: str, plugin: object) -> list[str]:
    """Duties of a kind that a class breaks; empty when it is a plug-in."""
    if not isinstance(plugin, type):
        return [f"{plugin!r} is not a class"]
    faults = []
    if not isinstance(plugin.__dict__.get("name"), str):
        faults.append("has no class attribute `name` (a string)")
    if not attrs.has(plugin):
        faults.append("is not an attrs class (decorate it with @attrs.frozen)")
    options = attrs.fields_dict(plugin) if attrs.has(plugin) else {}
    return faults + [f"has no `{duty}`" for duty in KINDS[kind][1] if not hasattr(plugin, duty) and duty not in options]
