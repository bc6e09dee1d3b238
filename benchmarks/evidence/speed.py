"""Speed, as ratios inside one run and as times of whole processes."""

from __future__ import annotations

from benchmarks.evidence import Row, below
from benchmarks.time_loop import LIMIT, SAME, measure

TITLE = "Speed"
COMMAND = "python -m benchmarks.time_loop --json"
#: Wall time of a whole `raceway run` with warm caches [s].
WHOLE_RUN = 2.0


def rows() -> list[Row]:
    found = measure()
    out = []
    for loop in found["loops"]:
        name = f"{loop['integrator']}, balls {loop['balls']}"
        ours, fused = loop["composed"] * 1e9, loop["fused"] * 1e9
        note = f"{ours:.0f} ns against {fused:.0f} ns a step of {loop['iterations']:.1f} iterations"
        out.append(below(f"composed over hand-fused time loop: {name}", loop["ratio"], LIMIT[loop["balls"]], COMMAND, note))
        out.append(below(f"largest relative difference of displacements: {name}", loop["deviation"], SAME, COMMAND))
    run, second = found["run"], found["second_process"]
    note = f"median {run['median_s']:.2f} s of {run['repeats']}"
    name = "`raceway run examples/b7206.toml`, warm caches: wall time, s"
    out.append(below(name, run["minimum_s"], WHOLE_RUN, COMMAND, note))
    note = f"the first compiles {second['first_compiled']} in {second['first_compile_s']:.1f} s"
    out.append(below("kernels that a second process compiles", second["compiled"], 0, COMMAND, note))
    changed = second["new_files"] + second["rewritten_files"]
    out.append(below("cache files that a second process adds or rewrites", changed, 0, COMMAND, f"of {second['files']}"))
    for name, light in found["light_commands"].items():
        note = f"{light['minimum_s']:.2f} s of wall time" + (": " + ", ".join(light["heavy"]) if light["heavy"] else "")
        out.append(below(f"heavy packages that `raceway {name}` loads", len(light["heavy"]), 0, COMMAND, note))
    return out
