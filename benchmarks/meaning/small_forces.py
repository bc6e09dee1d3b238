"""Tangent responses of damped contacts, and whole runs under forces far below the preload, against each other."""

from __future__ import annotations

from typing import Any

import raceway as rw
from benchmarks.evidence import Row, below, near

COMMAND = "python -m benchmarks.meaning small_forces"
#: Preload [N], and forces over it.
_PRELOAD = 400.0
_SHARES = (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
_KINDS: dict[str, dict[str, Any]] = {
    "balls with centrifugal force": {},
    "weightless balls": {"kinematics": {"ball_inertia": False}},
    "gyroscopic moments": {"kinematics": {"gyroscopic": "outer_race"}},
    "a radial load": {"load": {"radial": [300.0, 0.0]}},
    "tilt free": {"supports": {"tilt": "free"}},
    "contact.time_constant": {"contact": {"time_constant": 1e-5}},
}


def rows() -> list[Row]:
    return [*_damped(), *_periodic(), *_steps()]


def _run(identifier: str, integrator: str, share: float, speed: float, changes: dict[str, Any]) -> Any:
    tables: dict[str, Any] = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": _PRELOAD},
        "supports": {"tilt": "locked"},
        "kinematics": {"spin_speed_rpm": speed},
        "excitation": {"kind": "unidirectional", "amplitude": "constant", "force": _PRELOAD * share, "speed_rpm": speed},
        "integrator": {"kind": integrator},
        "identifier": {"kind": identifier},
    }
    for name, table in changes.items():
        tables[name] = {**tables.get(name, {}), **table}
    return rw.run(tables)


def _damped() -> list[Row]:
    """Tangent with dashpots in the contacts against the periodic motion under a small force."""
    out = []
    cases: tuple[tuple[float, str, dict[str, Any]], ...] = (
        (2.5e-5, "was 94.963", {}),
        (1e-4, "was 94.963", {}),
        (1e-4, "condensed bodies", {"bodies": {"kind": "condensed"}}),
        (1e-4, "orbiting balls", {"kinematics": {"orbiting": True}, "excitation": {"kind": "bidirectional"}}),
    )
    for tau, note, changes in cases:
        contact = {**changes, "contact": {"time_constant": tau}}
        tangent, run = (_run(kind, "periodic", 1e-4, 24000.0, contact).identification for kind in ("tangent", "fft_1x"))
        name = f"400 N, 24 000 r/min, tau = {tau:g} s, {note}"
        k, c = (1e-6 * one.equivalent_stiffness for one in (tangent, run))
        out.append(near(f"K of the tangent against a small motion, N/um, {name}", k, c, 1e-6, COMMAND))
        damping = tangent.equivalent_damping, run.equivalent_damping
        out.append(near(f"C, N s/m, {name}", *damping, 1e-6, COMMAND))
    return out


def _periodic() -> list[Row]:
    """Periodic motions under forces of 1e-8 to 1e-3 of the preload: Z against the tangent's, by what the run claims."""
    out = []
    for name, changes in _KINDS.items():
        tangent = _run("tangent", "periodic", 1e-4, 12000.0, changes).identification.dynamic_stiffness
        worst, lost, last = 0.0, 0, 0.0
        for share in _SHARES:
            try:
                run = _run("fft_1x", "periodic", share, 12000.0, changes)
            except rw.ConvergenceError:
                lost += 1
                continue
            last = abs(run.identification.dynamic_stiffness / tangent - 1.0)
            # What a motion is off the tangent by for its own size falls with the square of the force.
            worst = max(worst, max(last - share**2, 0.0) / run.error["total"])
        out.append(below(f"periodic, {name}: forces of {len(_SHARES)} that find no motion", lost, 0, COMMAND))
        out.append(below(f"periodic, {name}: largest distance from the tangent over error.total", worst, 1.0, COMMAND))
        out.append(below(f"periodic, {name}: distance at 1e-3 of the preload", last, 1e-6, COMMAND, "falls with its square"))
    return out


def _steps() -> list[Row]:
    """Newmark's method and generalised-alpha at the same forces."""
    out = []
    for integrator in ("newmark", "generalized_alpha"):
        tangent = _run("tangent", integrator, 1e-4, 12000.0, {}).identification.dynamic_stiffness
        worst = off = 0.0
        for share in (1e-6, 1e-5, 1e-4):
            run = _run("fft_1x", integrator, share, 12000.0, {})
            off = abs(run.identification.dynamic_stiffness / tangent - 1.0)
            worst = max(worst, off / run.error["total"])
        out.append(
            below(f"{integrator}: largest distance from the tangent over error.total, 1e-6 to 1e-4", worst, 3.0, COMMAND)
        )
        out.append(
            below(
                f"{integrator}: distance at 1e-4 of the preload",
                off,
                1e-6,
                COMMAND,
                "newmark was 3.1e-7 at 1e-4, 1.5e-5 at 1e-6",
            )
        )
    return out
