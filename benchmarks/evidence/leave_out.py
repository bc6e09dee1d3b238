"""What leaving out saves, rule by rule: ``benchmarks/leave_out.py``."""

from __future__ import annotations

from benchmarks.evidence import Row, below
from benchmarks.leave_out import MARGIN, RULES, planning

TITLE = "Leaving out: what a scene does not need, and what that saves"
COMMAND = "python -m benchmarks.leave_out"
_PLANNING_MS = 20.0


def rows() -> list[Row]:
    found = [rule() for rule in RULES.values()]
    out = [
        Row(
            "rules with a measured saving",
            float(sum(r.saves for r in found)),
            "at least 8",
            sum(r.saves for r in found) >= 8,
            COMMAND,
            f"of {len(found)}; a saving counts above {100 * MARGIN:g} % and the spread of the times",
        )
    ]
    out.append(below("planning, the kind of bodies that takes longest [ms]", 1e3 * planning(), _PLANNING_MS, COMMAND))
    for rule in found:
        value = (
            f"difference {rule.difference:.1e}; {1e3 * rule.cpu_s:.3g} ms instead of {1e3 * rule.cpu_forced_s:.3g}, "
            f"{rule.bytes / 2**20:.3g} MiB instead of {rule.bytes_forced / 2**20:.3g}"
        )
        cost = "it must save" if rule.must_save else "no dearer than the noise"
        limit = f"difference at most {rule.bound:g} ({rule.why}), {cost}"
        counted = "" if rule.saves else "not counted as a saving: within the margin, the spread of the times, or 0.1 ms"
        out.append(
            Row(
                f"left out: {rule.rule}",
                value,
                limit,
                rule.holds,
                COMMAND,
                "; ".join(part for part in (f"scene: examples/b7206.toml {rule.scene}".strip(), counted) if part),
            )
        )
    return out
