"""What this package adds to ``raceway``: a bearing as an FMU for simulators."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (
            rw.Command(
                "export --fmu",
                "raceway_fmu.export:export_fmu",
                "A bearing as an FMU (FMI 2.0, 3.0) for simulators: its map, or its force.",
                "raceway export --fmu examples/b7206.toml --range load.axial=400:2000 \\\n"
                "    --range excitation.speed_rpm=3000:15000\n"
                "raceway export --fmu examples/minimal.toml --kind force",
                {
                    "kind": rw.Option(choices=("map", "force")),
                    "ranges": rw.Option("range", "A.B=X:Y"),
                    "outputs": rw.Option("output", "NAME"),
                },
                folder="-fmu",
                pictures=None,
            ),
        )
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    return {"FMU": "raceway_fmu.export", "export_fmu": "raceway_fmu.export"}
