"""What this package adds to ``raceway``: the article's study: its figures and a verdict on each of its claims."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

import raceway as rw

if TYPE_CHECKING:
    import click


@attrs.frozen
class Article:
    """``raceway study article``."""

    name: ClassVar[str] = "article"
    help: ClassVar[str] = "The article's figures 9 to 12 and a verdict on each of its claims."

    def command(self) -> click.Command:
        example = (
            "raceway study article --bodies rigid --friction 0\n"
            "raceway study article examples/b7206.toml \\\n"
            "    --set rotor.mass=1.5 --axial 400,1000,2000\n"
            "raceway study article --bodies elastic --set mesh.element_size=2e-3"
        )
        options = {
            "bodies": rw.Option(choices=("rigid", "condensed", "both", "elastic")),
            **rw.Option.metavars(speeds="LIST", axial="LIST", shaft="N·M/RAD", friction="MU", turns="N"),
        }
        return rw.Command("article", "raceway_article.front:article", self.help, example, options, folder="-article").click()


@rw.hookimpl
def raceway_studies() -> list[type]:
    return [Article]
