"""``-v``: what a command computes as it goes, on standard error, through the logger ``raceway``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import logging
import shutil
import time
from typing import TYPE_CHECKING

import click

from raceway.framework.hookspecs import hookimpl

if TYPE_CHECKING:
    from raceway.pipeline.result import Result
    from raceway.planning.plan import ScenePlan

LOGGER = logging.getLogger("raceway")
#: Signs of a line that tell the time.
_TIME = 12


class _Lines(logging.Handler):
    """A line each on standard error, above a bar if one is drawn, with the seconds since the command began."""

    def __init__(self) -> None:
        super().__init__()
        self._begun = time.perf_counter()

    def emit(self, record: logging.LogRecord) -> None:
        from raceway.answers.wrapping import lines_of

        first, *following = lines_of(record.getMessage(), shutil.get_terminal_size().columns - _TIME) or [""]
        click.echo(f"{time.perf_counter() - self._begun:{_TIME - 4}.2f} s  {first}", err=True)
        for line in following:
            click.echo(" " * _TIME + line, err=True)


class _Listener:
    """Tells of each run's plan and of its parts' times, by the life-cycle hooks that plug-ins have, too."""

    @hookimpl
    def raceway_plan_made(self, plan: ScenePlan) -> None:
        steps = f", {plan.predicted_steps} steps in {plan.turns} turns" if plan.predicted_steps else ""
        LOGGER.info("plan: %d degrees of freedom%s, predicted %.2g s", plan.dofs, steps, plan.predicted_wall_s)
        for part in plan.kept:
            LOGGER.info("included: %s (%s)", part.part, part.why)
        LOGGER.info("left out: %s", ", ".join(part.part for part in plan.left_out) or "nothing")

    @hookimpl
    def raceway_run_finished(self, result: Result) -> None:
        cost = result.cost
        parts = [f"{word} {cost[name]:.2f} s" for word, name in _PARTS.items() if cost.get(name)]
        LOGGER.info("run finished in %.2f s: %s", cost["wall_s"], ", ".join(parts) or "nothing to build")
        from raceway.core.jit import clock

        cached = clock["loaded"] - clock["of_wheel"]
        LOGGER.info(
            "kernels: %d came compiled, %d from the cache, %d compiled now", clock["of_wheel"], cached, clock["compiled"]
        )
        if result.identification is not None:
            from raceway.answers.quantities import K

            LOGGER.info("K = %s at %g r/min", K.text(K.of(result)), 60.0 * result.identification.frequency_hz)

    @hookimpl
    def raceway_run_failed(self, error: Exception) -> None:
        LOGGER.info("run failed: %s", str(error).splitlines()[0] if str(error) else type(error).__name__)


#: Parts of a run's time, and their names in ``cost`` of result.json.
_PARTS = {"compiling": "compile_s", "building": "build_s", "solving": "solve_s", "error": "error_s"}


def listen(context: click.Context, _option: click.Parameter, verbose: bool) -> None:
    """Begin to report, until the command ends."""
    if not verbose:
        return
    from raceway.framework.registry import default_registry

    handler, listener, manager = _Lines(), _Listener(), default_registry().manager
    before = LOGGER.level
    LOGGER.addHandler(handler)
    LOGGER.setLevel(logging.INFO)
    manager.register(listener, name="raceway -v")

    def stop() -> None:
        manager.unregister(listener)
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(before)

    context.call_on_close(stop)
