"""What is identified in a run's motions, and what a run-up and friction leave in it.

Of a run-up the distance of each window from the steady motion at its speed is its error: free vibrations, an amplitude that lags
behind, and the steps in time are in it.  Where no such motion can be solved for, it is the identifier's own error of the window, plus
that of the time step.
"""

from math import pi

import attrs

from raceway.bodies.model import Equilibrium, Model
from raceway.core.record import Record
from raceway.core.signals import Identification
from raceway.errors import BeyondPlanError
from raceway.pipeline.simulate import OnProgress, Simulation, SteadyMotions

#: Relative error of Z in a window above which a warning states it.
_MUCH = 0.05


@attrs.frozen(eq=False)
class Identified:
    """Motions of a scene, and what is identified from them: of this errors are estimated.

    model, equilibrium : of the scene
    motions : one at each speed; empty where the identifier needs no motion
    on_progress : called in further runs and searches; the error of one that it ends is not known
    steady : steady motions of an excitation that changes its speed
    """

    model: Model
    equilibrium: Equilibrium
    motions: list[Simulation]
    identification: Identification
    on_progress: OnProgress | None = None
    steady: SteadyMotions = attrs.field(init=False)

    @steady.default
    def _steady_motions(self) -> SteadyMotions:
        return SteadyMotions(self.model, self.on_progress)

    @property
    def motion(self) -> Simulation:
        """That at the last speed."""
        return self.motions[-1]

    @property
    def value(self) -> complex:
        """Z [N/m]."""
        return self.identification.dynamic_stiffness

    @property
    def several_speeds(self) -> bool:
        return self.model.problem.several_speeds

    def identify(self, records: list[Record]) -> complex:
        """Z [N/m] by the scene's identifier."""
        return self.model.problem.identifier.method.identify(records, self.equilibrium, self.model).dynamic_stiffness


def start_warnings(model: Model, size: float | None, how: str) -> list[str]:
    """Says that an error is not known because no other start could be compared with."""
    if not model.problem.depends_on_start or size is not None:
        return []
    return [f"friction: the dependence of the answer on the start of the motion, and so its error, is unknown: {how}"]


def with_series_error(run: Identified, time_step: float | None) -> Identification:
    """The identification with ``series_error`` from steady motions where the speed changes.

    time_step : relative error of the time step

    Of windows whose search is ended by ``run.on_progress`` no error is stated.
    """
    identification, errors = run.identification, list[float | None]()
    if not identification.series_error:
        return identification
    has_reference = run.model.excitation.period_s is None and run.model.problem.compared_with_steady
    for (speed, z), error in zip(identification.series, identification.series_error, strict=True):
        try:
            reference = run.steady.value(speed) if has_reference else None
        except BeyondPlanError:  # of this window and of those to come nothing is known
            errors += [None] * (len(identification.series) - len(errors))
            break
        if reference is not None:
            errors.append(abs(z - reference) / min(abs(z), abs(reference)))
        else:
            errors.append(None if error is None else error + (time_step or 0.0))
    return attrs.evolve(identification, series_error=tuple(errors))


def series_warnings(identification: Identification | None) -> list[str]:
    """Says in which windows of a run-up Z is not that of the speed."""
    if identification is None:
        return []
    windows = zip(identification.series_error, identification.series, strict=False)
    errors = [(error, speed) for error, (speed, _) in windows if error is not None]
    bad = [speed * 30.0 / pi for error, speed in errors if not error <= _MUCH]
    if not bad:
        return []
    error, speed = max(errors)
    return [
        f"the motion lags behind the speed in {len(bad)} of {len(identification.series)} windows, {min(bad):.0f} to {max(bad):.0f} "
        f"r/min: the error of Z is up to {error:.2g} of |Z| there (at {speed * 30.0 / pi:.0f} r/min). Change the speed more slowly, or run these speeds one by one"
    ]
