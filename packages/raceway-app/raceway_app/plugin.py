"""What this package adds to ``raceway``: a page of a scene on this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway import hookimpl

if TYPE_CHECKING:
    from raceway.extend import Later


@hookimpl
def raceway_commands() -> dict[str, tuple[Later, ...]]:
    from raceway.extend import Later

    page = Later("app", "raceway_app.server:app_command", "A page to look at a scene and change it, on this machine.")
    return {"Answers": (page,)}


@hookimpl
def raceway_names() -> dict[str, str]:
    return {"app": "raceway_app.server"}
