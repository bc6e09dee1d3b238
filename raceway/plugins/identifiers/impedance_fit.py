"""K and C from the dynamic stiffness at several whirl speeds and one spin speed."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.options import option, worded
from raceway.plugins.identifiers.whole_turns import whole_turns

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.signals.identification import Identification
    from raceway.core.stepping.record import Record


#: Share by which the largest speed exceeds the smallest.  What Z has beyond its form, e w^2 with w over the mean speed, shifts K by e
#: and is seen as a misfit of e times that share: where the time step's error is as large, K is off by 1 / 0.05 = 20 times that error.
_APART = 0.05
_RULE = (
    f"at least two speeds greater than 0, the largest {100.0 * _APART:g} % or more above the smallest: closer ones hide a K that is off by "
    f"{1.0 / _APART:g} times the time step's error"
)


def _speeds(_instance: object, _attribute: object, value: tuple[float, ...]) -> None:
    if len(value) < 2 or min(value) <= 0.0 or max(value) < (1.0 + _APART) * min(value):
        raise ValueError(f"must be a list of {_RULE}")


@attrs.frozen
class ImpedanceFit:
    """K and C of Z(w) = K - m w^2 + j w C by least squares over whirl speeds, at the scene's spin speed and force; m is known.

    Notes
    -----
    K changes with the spin speed of the balls and with the amplitude: a fitted m would take what K loses over the speeds.  So
    spin and force are held, as a shaker on a turning rotor does, and m is that of ring and rotor, as in every K of this program.
    Free tilts lean with a shape that changes with w, and gyroscopic moments are linear in w: Z is of another form then, and the
    misfit tells.  ``window`` is the largest misfit over the whirl speeds, over |Z| there.
    """

    name: ClassVar[str] = "impedance_fit"
    needs: ClassVar[frozenset[str]] = frozenset({"record", "period", "speeds"})
    definition: ClassVar[str] = (
        "secant: K and C of Z = K - m w^2 + j w C, m known, by least squares over several whirl speeds at one spin speed"
    )

    speeds_rpm: tuple[float, ...] = option(
        unit="r/min",
        help="whirl speeds of the force that are run at the scene's spin speed, at least two; best around the scene's own",
        rule=worded(_speeds, _RULE),
    )

    @classmethod
    def examples(cls) -> list[ImpedanceFit]:
        """Instances for the conformance suite."""
        return [cls(speeds_rpm=(7200.0, 9600.0, 12000.0, 14400.0, 16800.0))]

    def identify(self, records: list[Record], equilibrium: Equilibrium, model: Model) -> Identification:
        import numpy as np

        from raceway.core.signals.identification import fourier_line, identification, stiffness

        records = [whole_turns(record) for record in records]
        w = np.array([2.0 * pi / (r.schedule.dt * r.schedule.steps_per_turn) for r in records])
        lines = [
            (fourier_line(r.time, r.force, s / (2.0 * pi)), fourier_line(r.time, r.displacement, s / (2.0 * pi)))
            for r, s in zip(records, w, strict=True)
        ]
        z = np.array([stiffness(force, line) for force, line in lines])
        own, mass = 2.0 * pi * model.excitation.frequency_hz, model.mass_used
        nearest = int(np.argmin(np.abs(w - own)))
        k, damping = float((z.real + mass * w**2).mean()), float((w @ z.imag) / (w @ w))
        fitted, here = k - mass * w**2 + 1j * w * damping, complex(k - mass * own**2, own * damping)
        away = np.abs(z - fitted)
        found = identification(self.definition, own / (2.0 * pi), *lines[nearest], mass_used=mass)
        return attrs.evolve(
            found,
            dynamic_stiffness=here,
            residual=float(np.sqrt(np.mean(away**2)) / abs(z).mean()),
            window=float((away / np.abs(z)).max()),
            series=tuple((float(s), complex(one)) for s, one in zip(w, z, strict=True)),
        )
