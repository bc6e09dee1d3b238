"""What this package adds to ``raceway``: pictures and pages of bodies, meshes and contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway import hookimpl

if TYPE_CHECKING:
    from raceway import Command


@hookimpl
def raceway_commands() -> dict[str, tuple[Command, ...]]:
    from raceway import Command, Option

    return {
        "Answers": (
            Command(
                "view",
                "raceway_view.view:view",
                "Draw a bearing: loads, contacts, mesh, orbit; PNG, HTML.",
                "raceway view examples/b7206.toml --html",
                {"page": Option("html")},
                pictures=None,
            ),
            Command(
                "view --mesh",
                "raceway_view.mesh:mesh",
                "Mesh the bodies of a scene: counts, quality, files.",
                "raceway view --mesh examples/b7206_article_mesh.toml --picture",
                {"form": Option("format", "NAME")},
                pictures=None,
            ),
        )
    }


@hookimpl
def raceway_names() -> dict[str, str]:
    return {"View": "raceway_view.view", "view": "raceway_view.view"}
