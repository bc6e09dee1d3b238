"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

stability, verify, view    one folder a command, with what it prints and draws
rotor       coefficients for ROSS, Nastran and Ansys, as CSV and JSON; the bearing in a rotor
fit         numbers of a scene from measured data, with what these do not determine
catalogue   the bearings of the catalogue; balls and grooves from printed numbers
article, rig         whole studies that end in a page: plug-ins of the hook ``raceway_studies``, as others' are
command     ``raceway study``
shaft       the rotor that ``rig`` and ``measured`` set the bearing in
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import attrs

from raceway.framework.hookspecs import hookimpl

if TYPE_CHECKING:
    import click


def _study(name: str, about: str, place: str) -> type:
    """The plug-in of a study.

    Parameters
    ----------
    place : module and name of its command, which is imported when it is asked for
    """
    module, _, function = place.partition(":")

    def command(self: object) -> click.Command:
        found: click.Command = getattr(import_module(module), function)
        return found

    content = {"__doc__": f"``raceway study {name}``.", "name": name, "help": about, "command": command}
    return attrs.make_class(name.capitalize(), [], class_body=content, frozen=True)


@hookimpl
def raceway_studies() -> list[type]:
    return [
        _study(
            "article",
            "The article's figures 9 to 12 and a verdict on each of its claims.",
            "raceway.studies.article.command:article",
        ),
        _study("rig", "A test rig's signals, and the bearing read back from them.", "raceway.studies.rig.page:rig"),
    ]
