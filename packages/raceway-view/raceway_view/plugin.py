"""What this package adds to ``raceway``: pictures and pages of bodies, meshes and contacts."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (
            rw.Command(
                "view",
                "raceway_view.view:view",
                "Draw a bearing: loads, contacts, mesh, orbit; PNG, HTML.",
                "raceway view examples/b7206.toml --html",
                {"page": rw.Option("html")},
                pictures=None,
            ),
            rw.Command(
                "view --mesh",
                "raceway_view.mesh:mesh",
                "Mesh the bodies of a scene: counts, quality, files.",
                "raceway view --mesh examples/b7206_article_mesh.toml --picture",
                {"form": rw.Option("format", "NAME")},
                pictures=None,
            ),
        )
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    return {"View": "raceway_view.view", "view": "raceway_view.view"}
