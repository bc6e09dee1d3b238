"""The exceptions of the package, one class by who must act.

``SceneError``: the user's file; ``PluginError``: a plug-in's author; ``MeshError``: the mesh;
``ConvergenceError`` and ``StabilityError``: the numbers; ``BeyondPlanError``: the time.  The command line
turns the first three into exit code 2 and the others into exit code 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs


class RacewayError(Exception):
    """Anything that this package refuses or fails at, with a message for a person.

    Attributes
    ----------
    state : the last good arrays of a run, by name
    files : what the command line has written of it, path by name
    """

    exit_code = 2

    def __init__(self, message: str = "", state: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.state = state or {}
        self.files: dict[str, str] = {}


def extra(name: str) -> str:
    """What to type for an extra of this package, which is installed from its sources."""
    return f"pip install '.[{name}]' in a checkout of Raceway"


@attrs.frozen
class Mistake:
    """One thing wrong in a scene: where, what stood there, the rule, and the way out."""

    path: str
    value: Any
    message: str

    def __str__(self) -> str:
        shown = "" if self.value is None else f" = {_short(self.value)}"
        return f"`{self.path}`{shown}: {self.message}"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


class SceneError(RacewayError):
    """A scene that cannot be used; carries every mistake that was found.

    Parameters
    ----------
    mistakes : sequence of Mistake
    """

    def __init__(self, mistakes: Sequence[Mistake]) -> None:
        self.mistakes = list(mistakes)
        super().__init__("\n".join(str(m) for m in self.mistakes))

    @classmethod
    def at(cls, path: str, value: Any, message: str) -> SceneError:
        return cls([Mistake(path, value, message)])


class PluginError(RacewayError):
    """A plug-in that cannot be loaded or that breaks its contract."""


class MeshError(RacewayError):
    """A mesh that cannot be read, built or used; ``mistake`` names the key of the scene where one is to blame."""

    mistake: Mistake | None = None

    @classmethod
    def at(cls, path: str, value: Any, message: str) -> MeshError:
        mistake = Mistake(path, value, message)
        error = cls(str(mistake))
        error.mistake = mistake
        return error


class ConvergenceError(RacewayError):
    """A solver that found no solution; ``state`` holds the last good arrays."""

    exit_code = 1


class BeyondPlanError(RacewayError):
    """A run that was stopped because it took many times its plan; no search takes it for a solution that was not found."""

    exit_code = 1


class StabilityError(ConvergenceError):
    """A step above the stable limit, or a motion that grew without bound."""
