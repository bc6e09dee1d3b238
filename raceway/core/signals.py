"""From 1x lines of force and displacement to a complex dynamic stiffness, with its quality figures.

Signals are Re(phasor e^{jwt}).  The line of the displacement that does work with the force counts: with F, x the complex
1x vectors of force and translation, Z = (F^H F) / (F^H x).  For a fixed direction that is force over displacement along
it; for a force that turns, the forward (or backward) parts of both.  Z = K - m w^2 + j w C.
"""

import attrs
import numpy as np


@attrs.frozen
class Identification:
    """A dynamic stiffness and how far it can be trusted.

    Attributes
    ----------
    dynamic_stiffness : complex, Z = F/x [N/m]
    mass_used : m of K = Re Z + m w^2 [kg]; 0 where the motion has no inertia
    equivalent_stiffness, equivalent_damping : K [N/m], C [N s/m]
    forward_amplitude, backward_amplitude, orbit_major, orbit_minor : of the 1x orbit [m]
    residual : rms of what is not 1x (mean and drift removed) over the rms of 1x, in the plane of the force
    spread : largest deviation of a single turn's Z from that of all turns, relative; None for one turn
    window : deviation of Z from the other fit (Fourier against least squares), relative, or the misfit of a fit over speeds;
        None where neither is known
    series : (speed [rad/s], Z) of every speed, where several were looked at
    series_error : relative error of Z of each of them, None where it is not known; empty where none is
    """

    definition: str
    frequency_hz: float
    force_amplitude: float
    dynamic_stiffness: complex
    mass_used: float
    forward_amplitude: float
    backward_amplitude: float
    orbit_major: float
    orbit_minor: float
    residual: float | None = None
    spread: float | None = None
    window: float | None = None
    series: tuple[tuple[float, complex], ...] = ()
    series_error: tuple[float | None, ...] = ()

    @property
    def speed(self) -> float:
        """w [rad/s]."""
        return 2.0 * np.pi * self.frequency_hz

    @property
    def equivalent_stiffness(self) -> float:
        return self.dynamic_stiffness.real + self.mass_used * self.speed**2

    @property
    def equivalent_damping(self) -> float:
        return self.dynamic_stiffness.imag / self.speed

    @property
    def phase_lag_deg(self) -> float:
        """Lag of the displacement behind the force [deg]."""
        return float(np.degrees(np.angle(self.dynamic_stiffness)))


def stiffness(force: np.ndarray, displacement: np.ndarray) -> complex:
    """Z [N/m] from the complex 1x vectors (3,) of force and translation; nan when one of them vanishes."""
    work = np.vdot(force[:3], displacement[:3])
    power = np.vdot(force[:3], force[:3])
    return complex(power / work) if abs(work) > 0.0 and abs(power) > 0.0 else complex(np.nan, np.nan)


def impedance(force: np.ndarray, line: np.ndarray) -> np.ndarray:
    """(n,) Z = (F^H F) / (F^H x) [N/m] of synchronous (1x) components (n, 3)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((force.conj() * force).sum(axis=1) / (force.conj() * line).sum(axis=1))


def steady_stiffness(force: np.ndarray, displacement: np.ndarray, change: np.ndarray) -> complex:
    """Z [N/m] of the steady motion, from the 1x vectors (5,) of one that changes under the additional forces ``change`` (5,).

    With D the (5, 5) dynamic stiffness of the steady motion, D x + change = F, and D (x + d) = F where D d = change, so that
    F^H d = (x + d)^H D^H d.  D is symmetric: along a motion whose stiffness is Z, D^H is D Z* / Z, and to first order in
    ``change`` F^H d = Z* / Z x^H change, moments on free tilts included.
    """
    value = stiffness(force, displacement)
    power, work = np.vdot(force[:3], force[:3]), np.vdot(force[:3], displacement[:3])
    if not abs(work) > 0.0 or not abs(value) > 0.0:
        return value
    return complex(power / (work + value.conjugate() / value * np.vdot(displacement, change)))


def identification(
    definition: str, frequency_hz: float, force: np.ndarray, displacement: np.ndarray, mass_used: float
) -> Identification:
    """An ``Identification`` from the complex 1x vectors (5,) of force and displacement, without quality figures."""
    forward = 0.5 * abs(displacement[1] + 1j * displacement[2])
    backward = 0.5 * abs(displacement[1] - 1j * displacement[2])
    # Real and imaginary part of the force vector are its values a quarter turn apart; the larger semi-axis is its amplitude.
    turning = np.sort(np.linalg.svd(np.array([force[:3].real, force[:3].imag]), compute_uv=False))
    return Identification(
        definition=definition,
        frequency_hz=frequency_hz,
        force_amplitude=float(turning[-1]),
        dynamic_stiffness=stiffness(force, displacement),
        mass_used=mass_used,
        forward_amplitude=float(forward),
        backward_amplitude=float(backward),
        orbit_major=float(forward + backward),
        orbit_minor=float(abs(forward - backward)),
    )


#: Rows of a matrix that no BLAS shares among threads, which takes many times as long as to factorise it.
_ROWS = 360


def least_squares(basis: np.ndarray, signal: np.ndarray) -> np.ndarray:
    """(m, k) coefficients of the columns of a basis (n, m) in a signal (n, k); long ones become triangles, block by block."""
    both, rows = np.hstack([basis, signal]), max(_ROWS, 4 * (basis.shape[1] + signal.shape[1]))
    while len(both) > rows:
        blocks = both[: len(both) // rows * rows].reshape(-1, rows, both.shape[1])
        both = np.vstack([*np.linalg.qr(blocks, mode="r"), both[blocks.shape[0] * rows :]])
    return np.asarray(np.linalg.lstsq(both[:, : basis.shape[1]], both[:, basis.shape[1] :], rcond=None)[0])


def fit_harmonics(
    time: np.ndarray, signal: np.ndarray, frequency_hz: float, harmonics: int
) -> tuple[np.ndarray, np.ndarray]:
    """Least squares of mean, drift and ``harmonics`` multiples of a frequency.

    Parameters
    ----------
    time : (n,) [s], equidistant;  signal : (n, k)

    Returns
    -------
    lines : (harmonics, k) complex phasors;  rest : (n, k) what the fit leaves

    Notes
    -----
    No drift is fitted to less than one and a half turns: over a single turn a straight line and a sine are alike, so that
    harmonics beyond those fitted would leak into the drift and from there into the first line.
    """
    wt = 2.0 * np.pi * frequency_hz * time[:, None] * np.arange(1, harmonics + 1)
    columns = [np.cos(wt), np.sin(wt), np.ones((len(time), 1))]
    if turns_in(time, frequency_hz) >= 1.5:
        span = time - time.mean()
        columns.append((span / np.abs(span).max())[:, None])
    basis = np.hstack(columns)
    solution = least_squares(basis, signal)
    return solution[:harmonics] - 1j * solution[harmonics : 2 * harmonics], signal - basis @ solution


def turns_in(time: np.ndarray, frequency_hz: float) -> float:
    """Turns that n equidistant samples cover, each standing for one step."""
    return float(len(time) * (time[1] - time[0]) * frequency_hz)


def _drift(time: np.ndarray, signal: np.ndarray, frequency_hz: float) -> tuple[np.ndarray, np.ndarray, np.ndarray | float]:
    """Times (n,) from the middle of a signal's whole turns, its mean (k,) over them, and the slope through their means; 0 of one turn."""
    turns = max(int(turns_in(time, frequency_hz) + 1e-6), 1)
    samples_per_turn = round(1.0 / (frequency_hz * (time[1] - time[0])))
    samples = min(turns * samples_per_turn, len(time))
    if turns < 2:
        return time, signal[:samples].mean(axis=0), 0.0
    means = signal[:samples].reshape(turns, samples_per_turn, -1).mean(axis=1)
    centres = time[:samples].reshape(turns, samples_per_turn).mean(axis=1)
    offset = centres - centres.mean()
    slope = offset @ (means - means.mean(axis=0)) / (offset @ offset)
    return time - centres.mean(), means.mean(axis=0), slope


def without_drift(time: np.ndarray, signal: np.ndarray, frequency_hz: float) -> np.ndarray:
    """The signal (n, k) less mean and straight line through the means of its whole turns; of one turn the mean only."""
    offset, mean, slope = _drift(time, signal, frequency_hz)
    return np.asarray(signal - mean - offset[:, None] * slope)


def synchronous_phasor(
    time: np.ndarray, signal: np.ndarray, frequency_hz: float, window: np.ndarray | float = 1.0
) -> np.ndarray:
    """1x phasor (k,) of a signal (n, k) over whole turns, after its drift over those turns is removed; ``window`` (n,) weighs samples."""
    kernel, (offset, mean, slope) = window * np.exp(-2j * np.pi * frequency_hz * time), _drift(time, signal, frequency_hz)
    parts = [
        part @ signal - part.sum() * mean - (part @ offset) * slope for part in (kernel.real.copy(), kernel.imag.copy())
    ]
    return np.asarray((parts[0] + 1j * parts[1]) * (2.0 / len(time)))


@attrs.frozen
class Line:
    """One line of the motion.

    name : "1x", "2x", "ball pass" ...;  frequency_hz : float
    forward, backward, axial : amplitudes [m]: turning with and against the spin, and along the axis
    """

    name: str
    frequency_hz: float
    forward: float
    backward: float
    axial: float


def phasors(time: np.ndarray, signal: np.ndarray, frequencies: list[float]) -> np.ndarray:
    """Complex phasors (len(frequencies), k) of a signal (n, k) by least squares, with mean and drift.

    Frequencies closer than half a line of the window to another one or to zero cannot be separated and must not be given.
    """
    wt = 2.0 * np.pi * time[:, None] * np.asarray(frequencies)
    span = time - time.mean()
    basis = np.hstack([np.ones((len(time), 1)), (span / np.abs(span).max())[:, None], np.cos(wt), np.sin(wt)])
    solution = least_squares(basis, signal)
    count = len(frequencies)
    return solution[2 : 2 + count] - 1j * solution[2 + count :]


def lines(time: np.ndarray, displacement: np.ndarray, frequencies: dict[str, float]) -> list[Line]:
    """Lines of a displacement (n, >= 3) x, y, z at named frequencies [Hz].

    Of frequencies that the window (time span T) cannot separate, |f1 - f2| < 0.5 / T, the first one remains; those
    above half the sampling rate are left out.
    """
    most = 0.5 * (len(time) - 1) / (time[-1] - time[0])
    least = 0.5 / (time[-1] - time[0])
    resolved: dict[str, float] = {}
    for name, frequency in frequencies.items():
        if frequency < most and all(abs(frequency - neighbour) >= least for neighbour in (0.0, *resolved.values())):
            resolved[name] = frequency
    amplitudes = phasors(time, displacement[:, :3], list(resolved.values()))
    return [
        Line(name, frequency, 0.5 * abs(y + 1j * z), 0.5 * abs(y - 1j * z), abs(x))
        for (name, frequency), (x, y, z) in zip(resolved.items(), amplitudes, strict=True)
    ]
