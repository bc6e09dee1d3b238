"""Parts of the model and of the program: each is kept or left out, and why."""

from __future__ import annotations

from collections.abc import Collection

import attrs


@attrs.frozen
class Part:
    """One part, and why it is kept or left out."""

    part: str
    why: str


class Decisions:
    """The parts of one scene, as they are decided.

    Parameters
    ----------
    force : parts that are kept although the scene does not need them
    """

    def __init__(self, force: Collection[str] = ()) -> None:
        self.force = force
        self.kept: list[Part] = []
        self.left_out: list[Part] = []

    def decide(self, needed: bool, part: str, why: str, why_not: str) -> bool:
        """Keep a part or leave it out; whether it is kept."""
        stays = needed or part in self.force
        (self.kept if stays else self.left_out).append(Part(part, why if needed else "forced" if stays else why_not))
        return stays

    def keeps(self, part: str) -> bool:
        """Whether a part was kept, by its name."""
        return any(one.part == part for one in self.kept)

    def keep(self, part: str, why: str) -> None:
        """A part that no scene of this kind can do without."""
        self.kept.append(Part(part, why))

    def leave_out(self, part: str, why: str) -> None:
        """A part that no scene of this kind has."""
        self.left_out.append(Part(part, why))
