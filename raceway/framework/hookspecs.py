"""Every hook that a plug-in may implement.  None of them is called inside a time loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from raceway.cli.command import Command
    from raceway.cli.commands import Later
    from raceway.pipeline.result import Result
    from raceway.planning.plan import ScenePlan

# A specification has no body: pluggy never calls it.  Mypy misses the return of those that declare one: empty-body.
hookspec = pluggy.HookspecMarker("raceway")
hookimpl = pluggy.HookimplMarker("raceway")


@hookspec
def raceway_contact_laws() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.ContactLaw``."""


@hookspec
def raceway_excitations() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Excitation``."""


@hookspec
def raceway_integrators() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Integrator``."""


@hookspec
def raceway_identifiers() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Identifier``."""


@hookspec
def raceway_bodies() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.BodiesKind``."""


@hookspec
def raceway_meshers() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Mesher``."""


@hookspec
def raceway_formats() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Format``."""


@hookspec
def raceway_quantities() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Quantities``."""


@hookspec
def raceway_executors() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Executor``."""


@hookspec
def raceway_studies() -> list[type]:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Study``."""


@hookspec
def raceway_commands() -> dict[str, tuple[Command | Later, ...]]:  # type: ignore[empty-body]
    """Commands beside ``raceway run``, by their heading in ``raceway --help``."""


@hookspec
def raceway_names() -> dict[str, str]:  # type: ignore[empty-body]
    """Public names of ``import raceway``, and "ross.NAME" of ``raceway.ross`` -> the modules that define them."""


@hookspec
def raceway_tables() -> dict[str, str]:  # type: ignore[empty-body]
    """Tables of the scene file that a study reads -> attrs classes of ``raceway.option`` as "module:Class"; the scene keeps them in ``source``."""


@hookspec
def raceway_plan_made(plan: ScenePlan) -> None:
    """A plan is ready; nothing has been built yet."""


@hookspec
def raceway_chunk_done(done: int, total: int) -> None:
    """A part of the time steps is done, or of a search, where ``total`` is 0; an exception stops the run."""


@hookspec
def raceway_run_finished(result: Result) -> None:
    """A run ended with a result."""


@hookspec
def raceway_run_failed(error: Exception) -> None:
    """A run ended with an error; ``error.state`` may hold the last good arrays."""
