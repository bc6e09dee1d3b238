"""One word of a scene changed: what it compiles, what another law's composed loop costs: ``python -m benchmarks.swapped``.

Prints JSON.  With the word ``cost`` it compares composed and hand-fused loops with the penalty law written into the latter
(in a process of its own, since the fused loops are compiled for one law), else it counts.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from benchmarks.processes import _python

#: The words that are changed one at a time.
WORDS = (
    'contact.kind="penalty"',
    'excitation.kind="unidirectional"',
    'integrator.kind="generalized_alpha"',
    'integrator.kind="central_difference"',
    'integrator.kind="quasi_static"',
    'identifier.kind="sine_fit"',
    'identifier.kind="order_tracking"',
    'identifier.kind="tangent"',
)


def count() -> list[dict[str, Any]]:
    """After the example has run: of each changed word the kernels compiled and the signatures that the loops have beyond their one."""
    from benchmarks.time_loop import EXAMPLE
    from raceway import load_scene
    from raceway.core.jit import clock
    from raceway.core.ring.equilibrium import settle
    from raceway.core.schemes.explicit.compiled import central_difference
    from raceway.core.schemes.one_step.compiled import implicit
    from raceway.core.schemes.static.compiled import quasi_static
    from raceway.pipeline.run import run

    run(load_scene(EXAMPLE))
    loops = (implicit, central_difference, quasi_static(settle))
    rows = []
    for word in WORDS:
        before = clock["compiled"]
        run(load_scene(EXAMPLE, (word,)))
        gained = sum(max(len(loop.signatures) - 1, 0) for loop in loops)
        rows.append({"word": word, "compiled": clock["compiled"] - before, "new_signatures": gained})
    return rows


def cost() -> list[dict[str, Any]]:
    """Composed over hand-fused time of a step with the penalty law."""
    import numba

    from benchmarks import fused_loop, time_loop

    @numba.njit
    def penalty(factor, damping, approach, rate):  # type: ignore[no-untyped-def]
        if approach <= 0.0:
            return 0.0, 0.0, 0.0
        force = factor * approach * approach + damping * rate
        if force <= 0.0:
            return 0.0, 0.0, 0.0
        return force, 2.0 * factor * approach, damping

    fused_loop.hertz = penalty
    loop: Any = time_loop
    plain = loop._fused

    def fused(model: Any, *words: Any) -> Any:
        params, z = model.system.law_params, model.geometry.ball_count
        inner, outer = SimpleNamespace(factor=params[0, 0]), SimpleNamespace(factor=params[z, 0])
        parts = {"system": model.system, "geometry": model.geometry, "scene": model.scene}
        return plain(SimpleNamespace(inner=inner, outer=outer, **parts), *words)

    loop._fused = fused
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "penalty.toml"
        text = time_loop.EXAMPLE.read_text(encoding="utf-8")
        path.write_text(text.replace('kind = "hertz"', 'kind = "penalty"'), encoding="utf-8")
        time_loop.EXAMPLE = path
        found = time_loop.loops(5)
    return [
        {"name": f"{one.integrator}, balls {one.balls}", "ratio": one.ratio, "deviation": one.deviation} for one in found
    ]


def in_a_process(word: str) -> list[dict[str, Any]]:
    """``count`` or ``cost`` in a fresh process."""
    found: list[dict[str, Any]] = json.loads(_python("-m", "benchmarks.swapped", word))
    return found


if __name__ == "__main__":
    print(json.dumps(cost() if sys.argv[1:] == ["cost"] else count()))
