"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

stability, verify, view    one folder a command, with its answer and pictures
rotor       coefficients for ROSS, Nastran and Ansys, as CSV and JSON; the bearing in a rotor
fit         numbers of a scene from measured data, with what these do not determine
catalogue   the bearings of the catalogue; balls and grooves from printed numbers
article, rig         whole studies that end in a page: plug-ins of the hook ``raceway_studies``, as others' are
shaft       the rotor that ``rig`` and ``measured`` set the bearing in
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
        from raceway.studies.article.command import article

        return article


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
