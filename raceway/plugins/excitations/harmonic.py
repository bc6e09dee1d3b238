"""Forces by a closed formula: harmonic along one direction, turning with the rotor, turning while the speed changes; loads of whirling
shafts, which studies make and no scene names."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any, ClassVar, Self

import attrs
import numpy as np

from raceway.core.deferred import deferred
from raceway.framework.options import at_least, between, finite, inside, one_of, option, positive
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.core.jit import Kernel


@deferred("FORCE")
def harmonic(t, params, out):
    """A force that rotates, or oscillates along one direction: out (5,), F_y = F (p3 cos + p4 sin)(W t - lag), F_z likewise with p5, p6.

    params: amplitude F [N], speed W [rad/s], lag [rad], then the cos and sin parts p3 to p6 of F_y and of F_z.
    """
    phase = params[1] * t - params[2]
    c, s = params[0] * np.cos(phase), params[0] * np.sin(phase)
    out[0] = 0.0
    out[1] = params[3] * c + params[4] * s
    out[2] = params[5] * c + params[6] * s
    out[3] = 0.0
    out[4] = 0.0


@attrs.frozen(kw_only=True)
class Amplitude:
    """Options of a harmonic force: how large it is at a speed, and when it peaks."""

    speed_rpm: float = option(unit="r/min", help="whirl speed = spin speed", rule=inside(0.0, 1e9))
    amplitude: str = option(
        "unbalance",
        help="'unbalance': load_share * unbalance * w^2; 'constant': at every speed",
        rule=one_of("unbalance", "constant"),
    )
    unbalance: float | None = option(None, unit="kg m", help="mass times eccentricity of the rotor", rule=at_least(0.0))
    load_share: float = option(1.0, help="share of the rotor's force that this bearing carries", rule=between(0.0, 1.0))
    force: float | None = option(None, unit="N", help="amplitude 'constant': force on this bearing", rule=at_least(0.0))
    reference_speed_rpm: float | None = option(
        None, unit="r/min", help="amplitude 'constant' without force: unbalance force at this speed", rule=positive()
    )
    phase_lag_deg: float = option(0.0, unit="deg", help="lag of the force behind the rotor's mark", rule=finite())
    ramp_turns: float = option(0.0, help="turns over which the force grows smoothly from zero", rule=at_least(0.0))

    def __attrs_post_init__(self) -> None:
        if self.amplitude == "unbalance" and self.unbalance is None:
            raise ValueError("`amplitude` = 'unbalance' needs the key `unbalance` (kg m)")
        computable = self.unbalance is not None and self.reference_speed_rpm is not None
        if self.amplitude == "constant" and self.force is None and not computable:
            why = "`amplitude` = 'constant' needs the key `force` (N), or `unbalance` and `reference_speed_rpm` to compute it from"
            raise ValueError(why)

    @classmethod
    def examples(cls, **options: Any) -> list[Self]:
        """Instances for the conformance suite, in every way to state the amplitude."""
        return [
            cls(speed_rpm=12000.0, unbalance=3.2e-4, **options),
            cls(speed_rpm=9000.0, unbalance=6e-4, load_share=0.5, phase_lag_deg=40.0, **options),
            cls(speed_rpm=15000.0, amplitude="constant", force=300.0, phase_lag_deg=-75.0, **options),
            cls(speed_rpm=15000.0, amplitude="constant", unbalance=6e-4, reference_speed_rpm=10980.0, **options),
        ]

    def unused_options(self) -> dict[str, str]:
        """Options that are given and change nothing, each with the reason."""
        unused = {}
        if self.amplitude == "unbalance":
            # reference_speed_rpm may stand ready for the other amplitude law: comparisons swap that one word.
            if self.force is not None:
                unused["force"] = "amplitude = 'unbalance' computes the force from unbalance and speed"
        elif self.force is not None:
            why = "the force is given"
            unused |= {name: why for name in ("unbalance", "reference_speed_rpm") if getattr(self, name) is not None}
            if self.load_share != 1.0:
                unused["load_share"] = "the force on this bearing is set directly"
        return unused

    @property
    def whirl_speed(self) -> float:
        """W [rad/s]."""
        return self.speed_rpm * pi / 30.0

    @property
    def frequency_hz(self) -> float:
        return self.speed_rpm / 60.0

    @property
    def period_s(self) -> float:
        return 60.0 / self.speed_rpm

    def phase(self, time: np.ndarray) -> np.ndarray:
        """Angle of the force (n,) [rad] at times (n,)."""
        return self.whirl_speed * time - np.radians(self.phase_lag_deg)

    @property
    def amplitude_n(self) -> float:
        """F0 on this bearing [N]."""
        if self.amplitude == "constant" and self.force is not None:
            return self.force
        speed = self.speed_rpm if self.amplitude == "unbalance" else self.reference_speed_rpm
        return (
            0.0 if self.unbalance is None or speed is None else self.load_share * self.unbalance * (speed * pi / 30.0) ** 2
        )

    def at_whirl(self, speed_rpm: float) -> Self:
        """The same force at another whirl speed [r/min]."""
        fixed: Tables = {"amplitude": "constant", "force": self.amplitude_n, "load_share": 1.0}
        return attrs.evolve(self, speed_rpm=speed_rpm, unbalance=None, reference_speed_rpm=None, **fixed)

    def kernel(self) -> Kernel:
        return harmonic()

    def _parameters(self, *parts: float | np.ndarray) -> np.ndarray:
        """Those of ``harmonic`` with its cos and sin parts; (n, 7) where options are columns (n,)."""
        numbers = self.amplitude_n, self.whirl_speed, np.radians(self.phase_lag_deg), *parts
        return np.stack(np.broadcast_arrays(*numbers), axis=-1)


@attrs.frozen(kw_only=True)
class Unidirectional(Amplitude):
    """F0 cos(W t - lag) along a direction in the radial plane."""

    name: ClassVar[str] = "unidirectional"
    elementwise: ClassVar[bool] = True

    direction_deg: float = option(0.0, unit="deg", help="direction of the force, from +y towards +z", rule=finite())

    @classmethod
    def examples(cls, **options: object) -> list[Self]:
        return [force for a in (0.0, 130.0) for force in super(Unidirectional, cls).examples(direction_deg=a, **options)]

    @property
    def sense(self) -> int:
        return 0

    def parameters(self) -> np.ndarray:
        direction = np.radians(self.direction_deg)
        return self._parameters(np.cos(direction), 0.0, np.sin(direction), 0.0)


@attrs.frozen(kw_only=True)
class Bidirectional(Amplitude):
    """F_y = F0 cos(W t - lag), F_z = F0 sin(W t - lag); backward whirl changes the sign of F_z."""

    name: ClassVar[str] = "bidirectional"
    elementwise: ClassVar[bool] = True

    whirl: str = option("forward", help="sense of rotation", rule=one_of("forward", "backward"))

    @classmethod
    def examples(cls, **options: object) -> list[Self]:
        senses = "forward", "backward"
        return [force for whirl in senses for force in super(Bidirectional, cls).examples(whirl=whirl, **options)]

    @property
    def sense(self) -> int:
        return 1 if self.whirl == "forward" else -1

    def parameters(self) -> np.ndarray:
        return self._parameters(1.0, 0.0, 0.0, float(self.sense))


@deferred("FORCE")
def run_up(t, params, out):
    """Unbalance while the speed changes linearly: out (5,), m e (w^2 n + w' n_perpendicular), w the momentary speed.

    params: unbalance on this bearing m e [kg m], first and last speed [rad/s], duration [s], lag [rad], sense.

    The centre of mass at e (cos phi, sin phi) accelerates by -e w^2 along the radius and by e w' across it; the force on
    the ring is the reaction.  Beyond the duration the speed stays.
    """
    duration = params[3]
    rate = (params[2] - params[1]) / duration
    if t < duration:
        w = params[1] + rate * t
        phase = params[1] * t + 0.5 * rate * t * t
    else:
        w = params[2]
        phase = 0.5 * (params[1] + params[2]) * duration + w * (t - duration)
        rate = 0.0
    phase -= params[4]
    c, s = np.cos(phase), np.sin(phase)
    radial, across = params[0] * w * w, params[0] * rate
    out[0] = 0.0
    out[1] = radial * c + across * s
    out[2] = params[5] * (radial * s - across * c)
    out[3] = 0.0
    out[4] = 0.0


@attrs.frozen(kw_only=True)
class RunUp:
    """m e w^2 with w from ``first_speed_rpm`` to ``speed_rpm`` over ``duration_s``; identify with 'order_tracking'."""

    name: ClassVar[str] = "run_up"

    first_speed_rpm: float = option(unit="r/min", help="speed at the beginning", rule=inside(0.0, 1e9))
    speed_rpm: float = option(unit="r/min", help="speed at the end", rule=inside(0.0, 1e9))
    duration_s: float = option(unit="s", help="time between the two", rule=positive())
    unbalance: float = option(unit="kg m", help="mass times eccentricity of the rotor", rule=at_least(0.0))
    load_share: float = option(1.0, help="share of the rotor's force that this bearing carries", rule=between(0.0, 1.0))
    phase_lag_deg: float = option(0.0, unit="deg", help="lag of the force behind the rotor's mark", rule=finite())
    whirl: str = option("forward", help="sense of rotation", rule=one_of("forward", "backward"))

    period_s: ClassVar[None] = None

    @classmethod
    def examples(cls) -> list[RunUp]:
        """Instances for the conformance suite."""
        common: Tables = {"duration_s": 0.5, "unbalance": 3.2e-4, "phase_lag_deg": 20.0}
        return [
            cls(first_speed_rpm=6000.0, speed_rpm=12000.0, **common),
            cls(first_speed_rpm=12000.0, speed_rpm=6000.0, whirl="backward", **common),
        ]

    @property
    def frequency_hz(self) -> float:
        """Frequency at the faster end, which sets the time step."""
        return max(self.speed_rpm, self.first_speed_rpm) / 60.0

    @property
    def amplitude_n(self) -> float:
        """Force at the end [N]."""
        return self.load_share * self.unbalance * (self.speed_rpm * pi / 30.0) ** 2

    @property
    def sense(self) -> int:
        return 1 if self.whirl == "forward" else -1

    def phase(self, time: np.ndarray) -> np.ndarray:
        """Angle of the force (n,) [rad] at times (n,)."""
        first, last = self.first_speed_rpm * pi / 30.0, self.speed_rpm * pi / 30.0
        changing = np.minimum(time, self.duration_s)
        turned = first * changing + 0.5 * (last - first) / self.duration_s * changing**2
        return turned + last * (time - changing) - np.radians(self.phase_lag_deg)

    def steady(self) -> Bidirectional:
        """The same rotor at its first speed."""
        same = {name: getattr(self, name) for name in ("unbalance", "load_share", "phase_lag_deg", "whirl")}
        return Bidirectional(speed_rpm=self.first_speed_rpm, **same)

    def parameters(self) -> np.ndarray:
        first, last = self.first_speed_rpm * pi / 30.0, self.speed_rpm * pi / 30.0
        share = self.load_share * self.unbalance
        return np.array([share, first, last, self.duration_s, np.radians(self.phase_lag_deg), float(self.sense)])

    def kernel(self) -> Kernel:
        return run_up()


@deferred("FORCE")
def one_frequency(t, params, out):
    """A load of one frequency: out (5,) from params (11,), speed [rad/s], then real and imaginary part of F_x, F_y, F_z [N], M_y, M_z [N m] e^{jwt}."""
    c, s = np.cos(params[0] * t), np.sin(params[0] * t)
    for i in range(out.size):
        out[i] = params[1 + 2 * i] * c - params[2 + 2 * i] * s


@attrs.frozen(kw_only=True)
class HarmonicLoad(Bidirectional):
    """Complex amplitudes (5,) of F_x, F_y, F_z [N], M_y, M_z [N m]; the load is their real part times e^{jwt}."""

    amplitudes: tuple[complex, ...] = (0.0,) * 5

    def parameters(self) -> np.ndarray:
        return np.concatenate([[self.whirl_speed], np.array(self.amplitudes, dtype=complex).view(float)])

    def kernel(self) -> Kernel:
        return one_frequency()


def harmonic_load(speed: float, load: np.ndarray) -> HarmonicLoad:
    """The excitation of a load (5,) [N, N m] at a speed [rad/s]."""
    largest = float(np.abs(load[:3]).max())
    rpm, amplitudes = speed * 30.0 / pi, tuple(map(complex, load))
    return HarmonicLoad(speed_rpm=rpm, amplitude="constant", force=largest, amplitudes=amplitudes)
