"""Records of a shaker on a mass, spring and dashpot in one direction or two, in closed form."""

import numpy as np

#: Samples, their rate [Hz], and the band of the force [Hz].
SAMPLES, RATE, BAND = 4096, 8000.0, (20.0, 1500.0)


def record(
    stiffness: float, damping: float, mass: float, seed: int, noise_db: float = 40.0, lines: int = 60
) -> dict[str, np.ndarray]:
    """Force and displacement of a system that begins at rest under a sum of sines, each with white noise.

    stiffness, damping, mass : [N/m, N s/m, kg]
    noise_db : rms of a signal over that of its noise, of force and displacement alike
    lines : sines of 10 N at frequencies that are no lines of the record's transform
    dict : time_s, force_n, x_m, (n,) each
    """
    random = np.random.default_rng(seed)
    t = np.arange(SAMPLES) / RATE
    w = 2.0 * np.pi * np.sort(random.uniform(*BAND, lines))
    force = 10.0 * np.exp(2j * np.pi * random.uniform(size=lines))
    moved = force / (stiffness - mass * w**2 + 1j * w * damping)
    turning = np.exp(1j * np.outer(t, w))
    f, x = (turning @ force).real, (turning @ moved).real
    # The free motion that makes displacement and speed zero at the beginning.
    place, speed = float(moved.real.sum()), float((1j * w * moved).real.sum())
    if mass > 0.0:
        decay = 0.5 * damping / mass
        free = np.sqrt(stiffness / mass - decay**2)
        x = x - np.exp(-decay * t) * (place * np.cos(free * t) + (speed + decay * place) / free * np.sin(free * t))
    elif damping > 0.0:
        x = x - place * np.exp(-stiffness / damping * t)
    part = 10.0 ** (-noise_db / 20.0)
    f, x = (one + part * one.std() * random.standard_normal(SAMPLES) for one in (f, x))
    return {"time_s": t, "force_n": f, "x_m": x}


def turning_record(stiffness: np.ndarray, damping: np.ndarray, mass: float, seed: int) -> dict[str, np.ndarray]:
    """Periodic forces along y and z and their displacements, with 40 dB of noise each.

    stiffness, damping : (2, 2) [N/m, N s/m]
    """
    random = np.random.default_rng(seed)
    t = np.arange(SAMPLES) / RATE
    low, high = (int(one * SAMPLES / RATE) for one in BAND)
    w = 2.0 * np.pi * np.arange(low, high) * RATE / SAMPLES
    force = 10.0 * np.exp(2j * np.pi * random.uniform(size=(len(w), 2)))
    z = stiffness - mass * (w**2)[:, None, None] * np.eye(2) + 1j * w[:, None, None] * damping
    moved = np.linalg.solve(z, force[..., None])[..., 0]
    turning = np.exp(1j * np.outer(t, w))
    f, x = (turning @ force).real, (turning @ moved).real
    f, x = (one + 0.01 * one.std() * random.standard_normal(one.shape) for one in (f, x))
    return {"time_s": t, "force_y_n": f[:, 0], "force_z_n": f[:, 1], "y_m": x[:, 0], "z_m": x[:, 1]}


def hammer_record(stiffness: float, damping: float, mass: float, seed: int, pulses: int = 4) -> dict[str, np.ndarray]:
    """Half-sine pulses of 0.25 to 0.45 ms and the displacement, sampled without a filter, with 40 dB of noise each.  The
    state goes exactly through a force that is linear between times 64 times as dense as the samples."""
    from scipy.signal import cont2discrete, lfilter, ss2tf

    random, dense = np.random.default_rng(seed), 64
    t = np.arange(SAMPLES * dense) / (RATE * dense)
    force = np.zeros(len(t))
    for _ in range(pulses):
        begin, width, size = random.uniform(0.0, 0.9 * t[-1]), random.uniform(2.5e-4, 4.5e-4), random.uniform(140.0, 260.0)
        phase = (t - begin) / width
        force += np.where((phase > 0.0) & (phase < 1.0), size * np.sin(np.pi * phase), 0.0)
    a, b = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]]), np.array([[0.0], [1.0 / mass]])
    system = a, b, np.array([[1.0, 0.0]]), np.zeros((1, 1))
    up, down = ss2tf(*cont2discrete(system, t[1], method="foh")[:4])
    f, x = (one[::dense] for one in (force, lfilter(up[0], down, force)))
    f, x = (one + 0.01 * one.std() * random.standard_normal(SAMPLES) for one in (f, x))
    return {"time_s": t[::dense], "force_n": f, "x_m": x}
