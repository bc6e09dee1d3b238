"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

stability, verify, view    one folder a command, with its answer and pictures
rotor       coefficients for ROSS, Nastran and Ansys, as CSV and JSON; the bearing in a rotor
fmu         the bearing as an FMU for simulators
app         a page of a scene, served to this machine
fit         numbers of a scene from measured data, with what these do not determine
catalogue   the bearings of the catalogue; balls and grooves from printed numbers
article, rig         whole studies that end in a page: plug-ins of the hook ``raceway_studies``, as others' are
shaft       the rotor that ``rig`` and ``fit`` set the bearing in
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.framework.hookspecs import hookimpl

if TYPE_CHECKING:
    import click


@attrs.frozen
class Article:
    """``raceway study article``."""

    name: ClassVar[str] = "article"
    help: ClassVar[str] = "The article's figures 9 to 12 and a verdict on each of its claims."

    def command(self) -> click.Command:
        from raceway import Command, Option

        example = (
            "raceway study article --bodies rigid --friction 0\n"
            "raceway study article examples/b7206.toml \\\n"
            "    --set rotor.mass=1.5 --axial 400,1000,2000\n"
            "raceway study article --bodies elastic --set mesh.element_size=2e-3"
        )
        options = {
            "bodies": Option(choices=("rigid", "condensed", "both", "elastic")),
            "speeds": Option(metavar="LIST"),
            "axial": Option(metavar="LIST"),
            "shaft": Option(metavar="N·M/RAD"),
            "friction": Option(metavar="MU"),
            "turns": Option(metavar="N"),
        }
        return Command(
            "article", "raceway.studies.article.front:article", self.help, example, options, folder="-article"
        ).click()


@attrs.frozen
class Rig:
    """``raceway study rig``."""

    name: ClassVar[str] = "rig"
    help: ClassVar[str] = "A test rig's signals, and the bearing read back from them."

    def command(self) -> click.Command:
        from raceway import Command

        example = "raceway study rig examples/test_rig.toml --set rig.sensor_distance=0.03"
        return Command("rig", "raceway.studies.rig.study:rig", self.help, example, folder="-rig").click()


@hookimpl
def raceway_studies() -> list[type]:
    return [Article, Rig]
