"""Every hook that a plug-in may implement.  None of them is called inside a time loop.

A hook of classes may also return a mapping of their names to "module:Class": a class is then imported when a scene or a command
names it, or when somebody asks for all of its kind.
"""

from typing import Any, Protocol

import click
import pluggy

Classes = list[type] | dict[str, str]


class NamedCommand(Protocol):
    """A ``raceway.Command``, or what else makes a command when its name is called."""

    @property
    def name(self) -> str: ...
    @property
    def summary(self) -> str: ...
    def click(self) -> click.Command: ...


# A specification has no body: pluggy never calls it.  Mypy misses the return of those that declare one: empty-body.
hookspec = pluggy.HookspecMarker("raceway")
hookimpl = pluggy.HookimplMarker("raceway")


@hookspec
def raceway_contact_laws() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.ContactLaw``."""


@hookspec
def raceway_excitations() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Excitation``."""


@hookspec
def raceway_integrators() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Integrator``."""


@hookspec
def raceway_identifiers() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Identifier``."""


@hookspec
def raceway_bodies() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.BodiesKind``."""


@hookspec
def raceway_meshers() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Mesher``."""


@hookspec
def raceway_formats() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Format``."""


@hookspec
def raceway_quantities() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Quantities``."""


@hookspec
def raceway_executors() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Executor``."""


@hookspec
def raceway_studies() -> Classes:  # type: ignore[empty-body]
    """Classes that follow ``raceway.framework.contracts.Study``."""


@hookspec
def raceway_commands() -> dict[str, tuple[NamedCommand, ...]]:  # type: ignore[empty-body]
    """Commands beside ``raceway run``, by their heading in ``raceway --help``; "dev": those of ``raceway dev``."""


@hookspec
def raceway_names() -> dict[str, str]:  # type: ignore[empty-body]
    """Public names of ``import raceway``, and "ross.NAME" of ``raceway.ross`` -> the modules that define them."""


@hookspec
def raceway_tables() -> dict[str, str]:  # type: ignore[empty-body]
    """Tables of the scene file that a study reads -> attrs classes of ``raceway.option`` as "module:Class"; the scene keeps them in ``source``."""


@hookspec
def raceway_plan_made(plan: Any) -> None:
    """A plan, a ``raceway.planning.plan.ScenePlan``, is ready; nothing has been built yet."""


@hookspec
def raceway_chunk_done(done: int, total: int) -> None:
    """A part of the time steps is done, or of a search, where ``total`` is 0; an exception stops the run."""


@hookspec
def raceway_run_finished(result: Any) -> None:
    """A run ended with a ``raceway.Result``."""


@hookspec
def raceway_run_failed(error: Exception) -> None:
    """A run ended with an error; ``error.state`` may hold the last good arrays."""
