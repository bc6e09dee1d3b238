"""The article's own model in motion: a million hexahedra with friction and unbalance, both excitations, beside condensed bodies."""

from __future__ import annotations

from benchmarks.evidence import Row, below
from benchmarks.evidence._kept import kept
from benchmarks.evidence.article_mesh import CONDENSED, GIB, compiled, measured, typed

TITLE = "The article's mesh in motion"
COMMAND = "python -m benchmarks.evidence article_motion"
#: One operating point in motion: 12 000 r/min, the rig's unbalance, friction; both excitations.
MOTION = {
    "rotor.mass": "2.0", "excitation.speed_rpm": "12000", "excitation.unbalance": "6.39e-4", "excitation.load_share": "0.5",
    "excitation.reference_speed_rpm": "10980", "contact.friction": "0.03", "contact.stick_stiffness": "1e7", "integrator.kind": "newmark", "integrator.tolerance": "1e-5",
    "integrator.start": "orbit", "integrator.turns": "2", "integrator.steps_per_turn": "40", "identifier.kind": "fft_1x",
}  # fmt: skip
EXCITATIONS = {
    "one direction, constant": {"excitation.kind": "unidirectional", "excitation.amplitude": "constant"},
    "rotating, m e w2": {"excitation.kind": "bidirectional", "excitation.amplitude": "unbalance"},
}


def rows() -> list[Row]:
    return kept("article_motion", [(_motion, name) for name in EXCITATIONS])


def _motion(name: str) -> list[Row]:
    changes = {**MOTION, **EXCITATIONS[name]}
    compiled({**changes, "integrator.turns": "1", "integrator.steps_per_turn": "8"})
    mine, other = measured(dict(changes)), measured({**changes, **CONDENSED})
    command = typed(dict(changes))
    k, wanted = (float(found["identification"]["equivalent_stiffness"]) for found in (mine, other))
    note = f"{1e-6 * k:.3f} and {1e-6 * wanted:.3f} N/µm, the same 2 turns of 40 steps"
    cost = "start on the orbit, equilibria and the identification included, from nothing"
    return [
        below(f"{name}: 2 turns of 40 steps with friction, CPU-s", mine["cpu_s"], 900.0, command, cost),
        below(f"{name}: memory at the peak [GiB]", mine["peak_bytes"] / GIB, 16.0, command),
        below(f"{name}: K against condensed bodies, relative", abs(k / wanted - 1.0), 0.01, command, note),
        below(f"{name}: energy balance", float(mine["stability"]["energy_drift"]), 1e-3, command),
    ]
