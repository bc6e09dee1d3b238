"""Every hook that a plug-in may implement.  None of them is called inside a time loop.

A hook of classes may also return a mapping of their names to "module:Class": a class is then imported when a scene or a command
names it, or when somebody asks for all of its kind.
"""

from collections.abc import Callable
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


def _classes(contract: str) -> Callable[[], Classes]:
    def hook() -> Classes:  # type: ignore[empty-body]
        pass

    hook.__doc__ = f"Classes that follow ``raceway.framework.contracts.{contract}``."
    return hookspec(hook)


raceway_contact_laws = _classes("ContactLaw")
raceway_excitations = _classes("Excitation")
raceway_integrators = _classes("Integrator")
raceway_identifiers = _classes("Identifier")
raceway_bodies = _classes("BodiesKind")
raceway_meshers = _classes("Mesher")
raceway_formats = _classes("Format")
raceway_quantities = _classes("Quantities")
raceway_executors = _classes("Executor")
raceway_studies = _classes("Study")


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
