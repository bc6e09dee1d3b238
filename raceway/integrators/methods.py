"""Time integration by Newmark's method, generalised-alpha and central differences; series of equilibria, steady orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.core.time.schemes import Drivers, Explicit, OneStep, Static
from raceway.errors import ConvergenceError
from raceway.framework.options import between, inside, one_of, option, optional, positive

if TYPE_CHECKING:
    from raceway.core.record import Motion, OnChunk, Record, Schedule
    from raceway.core.ring.system import System


@attrs.frozen
class Newmark:
    """Average acceleration by default: second order, no dissipation, unconditionally stable on linear systems."""

    name: ClassVar[str] = "newmark"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    gamma: float = option(0.5, help="0.5: second order, no dissipation", rule=between(0.5, 1.0))
    beta: float = option(0.25, help="0.25: average acceleration", rule=inside(0.0, 1.0))
    tolerance: float = option(1e-9, help="residual of a step's iteration over the largest force", rule=inside(0.0, 1e-3))

    def __attrs_post_init__(self) -> None:
        if 2.0 * self.beta < self.gamma:
            why = f"`beta` = {self.beta:g} must be at least gamma / 2 = {self.gamma / 2:g}: else steps are not unconditionally stable"
            raise ValueError(why)

    @property
    def scheme(self) -> OneStep:
        """The implicit one-step scheme without weights of the old step."""
        return OneStep(beta=self.beta, gamma=self.gamma, tolerance=self.tolerance)


@attrs.frozen
class GeneralizedAlpha:
    """Second order with dissipation of the highest frequencies, set by the spectral radius at infinity."""

    name: ClassVar[str] = "generalized_alpha"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = True

    rho_infinity: float = option(
        0.9, help="spectral radius at infinite frequency: 1 none, 0 all dissipated", rule=between(0.0, 1.0)
    )
    tolerance: float = option(1e-9, help="residual of a step's iteration over the largest force", rule=inside(0.0, 1e-3))

    @classmethod
    def examples(cls) -> list[GeneralizedAlpha]:
        """Instances for the conformance suite."""
        return [cls(), cls(rho_infinity=0.5)]

    @property
    def scheme(self) -> OneStep:
        """Chung and Hulbert's numbers: second order, and as little dissipation of low frequencies as can be."""
        rho = self.rho_infinity
        am, af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        return OneStep(am, af, 0.25 * (1.0 - am + af) ** 2, 0.5 - am + af, self.tolerance)


@attrs.frozen
class CentralDifference:
    """Explicit, second order, symplectic; the step must stay below 2 / (largest natural frequency).

    Notes
    -----
    ``least_step`` adds mass to the elements of elastic bodies whose own stable step is smaller, and to no others; contacts still
    limit the step.  ``model.mass_scaling`` of result.json has what is added.
    """

    name: ClassVar[str] = "central_difference"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = False
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    least_step: float | None = option(
        None,
        unit="s",
        help="stable step that finite elements have at least, by added mass; None: no mass is added",
        rule=optional(positive()),
    )
    device: str = option(
        "cpu",
        help="'gpu': a CUDA device steps elastic bodies, formulation 'one_point', contacts 'nodal'; 'auto': where it can",
        rule=one_of("cpu", "gpu", "auto"),
    )

    @property
    def scheme(self) -> Explicit:
        """Central differences."""
        return Explicit(self.device)


@attrs.frozen
class QuasiStatic:
    """No inertia and no rates: what the bearing would do if it turned infinitely slowly under the same forces."""

    name: ClassVar[str] = "quasi_static"
    order: ClassVar[int] = 2
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = False
    steady: ClassVar[bool] = False
    dissipative: ClassVar[bool] = False

    tolerance: float = option(1e-11, help="residual of an equilibrium over the sum of forces", rule=inside(0.0, 1e-3))

    @property
    def scheme(self) -> Static:
        """Equilibria."""
        return Static(self.tolerance)


@attrs.frozen
class Periodic:
    """The motion that repeats every turn, by collocation at Gauss points; its mesh follows the error.

    Notes
    -----
    No transient, so ``integrator.turns`` and ``start`` have no effect; ``steps_per_turn`` is the number of samples of the
    answer, not of the method.  A force that turns over equal balls is solved over one ball pitch.  result.json has the
    Floquet multipliers in ``stability``.
    """

    name: ClassVar[str] = "periodic"
    order: ClassVar[int] = 8
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    dissipative: ClassVar[bool] = False
    steady: ClassVar[bool] = True
    orbit: ClassVar[bool] = True

    tolerance: float = option(
        1e-7, help="estimated error of the displacement over the amplitude of the motion", rule=inside(1e-12, 1e-2)
    )
    symmetry: str = option(
        "auto", help="'auto': one ball pitch where forces and bodies allow it; 'none': always one turn", rule=one_of("auto", "none")
    )  # fmt: skip

    @classmethod
    def examples(cls) -> list[Periodic]:
        """Instances for the conformance suite."""
        return [cls(), cls(symmetry="none")]

    @property
    def scheme(self) -> Drivers:
        """Collocation needs thousands of evaluations: of compiled forces only."""
        return Drivers(compiled=self.solve)

    def solve(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """The motion that repeats itself, sampled at the steps of a schedule."""
        from raceway.core.periodic.steady import steady

        try:
            return steady(system, start, schedule, self.tolerance, self.symmetry == "auto", on_chunk)
        except ConvergenceError as why:
            if why.state:
                raise
            # Only the corrector of a branch that fails at its first point, the resting ring, leaves no state.
            raise ConvergenceError(
                "no motion with the period of the force was found: the branch from rest ends at 0 % of the force, where "
                f"its branch begins ({why}). Use integrator.kind = 'quasi_static' for speeds far below the natural frequencies; "
                "at others a transient integrator with start = 'ramp' shows the motion of the ring.",
                {"q": start.q.copy()},
            ) from why
