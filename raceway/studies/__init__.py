"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.pipeline.run`` and never reach into a time loop.

many        what they share: the engine (items in, rows out, kept and resumed), points, axes, row store, pages
compare, precision, stability, sweep, verify, view, ross, measured    one folder a command, with what it prints and draws
article, rig, map    whole studies that end in a page: plug-ins of the hook ``raceway_studies``, as others' are
command     ``raceway study``
shaft       the rotor that ``rig`` and ``measured`` set the bearing in
"""

from __future__ import annotations

from typing import Any, ClassVar

import attrs

from raceway.framework.hookspecs import hookimpl


@attrs.frozen
class Article:
    """``raceway study article``."""

    name: ClassVar[str] = "article"
    help: ClassVar[str] = "The article's figures 9 to 12 and a verdict on each of its claims."

    def command(self) -> Any:
        from raceway.studies.article.command import article

        return article


@attrs.frozen
class Rig:
    """``raceway study rig``."""

    name: ClassVar[str] = "rig"
    help: ClassVar[str] = "A test rig's signals, and the bearing read back from them."

    def command(self) -> Any:
        from raceway.studies.rig.command import rig

        return rig


@attrs.frozen
class Map:
    """``raceway study map``."""

    name: ClassVar[str] = "map"
    help: ClassVar[str] = "Hardening or softening of k(speed) over axial load, tilt and contact angle."

    def command(self) -> Any:
        from raceway.studies.map.command import study_map

        return study_map


@hookimpl
def raceway_studies() -> list[type]:
    return [Article, Rig, Map]
