"""What this package adds to ``raceway``: fits to measurements, and a test rig's signals."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

import raceway as rw

if TYPE_CHECKING:
    import click


@attrs.frozen
class Rig:
    """``raceway study rig``."""

    name: ClassVar[str] = "rig"
    help: ClassVar[str] = "A test rig's signals, and the bearing read back from them."

    def command(self) -> click.Command:
        example = "raceway study rig examples/test_rig.toml --set rig.sensor_distance=0.03"
        return rw.Command("rig", "raceway_measure.rig.study:rig", self.help, example, folder="-rig").click()


@rw.hookimpl
def raceway_studies() -> list[type]:
    return [Rig]


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (
            rw.Command(
                "fit",
                "raceway_measure.fit.fit:fit_texts",
                "Fit scene parameters, or K and C of a rig's bearing, to measurements.",
                "raceway fit measured-k.csv --scene examples/b7206.toml \\\n"
                "    --free bearing.contact_angle_deg\n"
                "raceway fit shaker.csv --free K,C,mass\n"
                "raceway study rig examples/test_rig.toml --out rig\n"
                "raceway identify rig/signals-13000rpm-400N.csv \\\n"
                "    --scene examples/test_rig.toml --set load.axial=400 \\\n"
                "    --slow-roll rig/slow-roll-13000rpm-400N.csv\n"
                "raceway identify orbit.csv --scene examples/test_rig.toml \\\n"
                '    --map "Ch 1=y_um" --map "Ch 2=z_um"',
                {
                    "data": rw.Option(positional=True),
                    "scene": rw.Option("scene"),
                    "columns": rw.Option("map", '"HEADER=NAME"'),
                    **rw.Option.metavars(free="A.B,C.D", mass="KG", slow_roll="FILE.csv", run_out="UM,DEG"),
                },
                folder="-fitted",
                named_by="data",
                aliases=("identify",),
            ),
        )
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    return {
        "fit": "raceway_measure.fit.fit",
        "Fitted": "raceway_measure.fit.fitted",
        "Identified": "raceway_measure.fit.identified",
        "identify": "raceway_measure.fit.identify",
    }
