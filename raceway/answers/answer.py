"""What a public function answers: shown on a screen and in a notebook, written as JSON, text and picture, by one writer each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, TypeAlias

from raceway.errors import RacewayError
from raceway.framework.doors import PATH, TEXT, TEXTS, door
from raceway.framework.shown import Fact, Shown
from raceway.storage.files import write_json, write_whole
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

#: A sentence, the rows of a table, or anything that rich prints.
Part: TypeAlias = "str | list[dict[str, str]] | RenderableType"


class Answer(Shown):
    """Facts for people, plain tables for programs, a figure.

    A subclass states ``to_dict`` and ``report`` (of a terminal); where it has them, ``draw``, ``texts``, and ``_facts`` of ``repr`` and
    notebooks.

    Attributes
    ----------
    stem : of the names of its files: ``band`` writes band.json and band.png

    Examples
    --------
    >>> import raceway as rw
    >>> class Stiffness(rw.Answer):
    ...     stem = "stiffness"
    ...
    ...     def to_dict(self):
    ...         return {"title": "B7206C", "kyy": "235 N/um"}
    >>> Stiffness()
    B7206C
      kyy  235 N/um
    """

    __slots__ = ()
    stem: ClassVar[str]

    @property
    def passed(self) -> bool:
        """Whether a command ends with 0, else with 1."""
        return True

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        raise NotImplementedError

    def _facts(self) -> tuple[str, Sequence[Fact]]:
        """Title and plain numbers of ``to_dict``; answers with more to say state it themselves."""
        content = self.to_dict()
        facts = [(name.replace("_", " "), str(value), "") for name, value in content.items() if name != "title"]
        return str(content.get("title", self.stem)), facts

    def report(self) -> Iterable[Part]:
        """What a terminal shows: sentences, rows of tables, or what rich prints."""
        raise NotImplementedError

    def texts(self, pictures: bool) -> Mapping[str, str]:
        """Further files of text: suffix -> content; ``pictures``: whether the picture lies beside them."""
        return {}

    def draw(self) -> Figure | None:
        """The picture; None: there is nothing to draw."""
        return None

    def drawings(self) -> Mapping[str, Figure]:
        """Pictures by the names of their files."""
        figure = self.draw()
        return {} if figure is None else {self.stem: figure}

    def failure(self) -> RacewayError | None:
        """What makes a finished answer worthless, raised after it has been shown and written."""
        return None

    @door
    def save(self, folder: Annotated[str | Path, PATH], pictures: bool | str = False) -> list[Path]:
        """Write JSON and texts into a folder, and the picture where ``pictures`` asks for it: "svg" or "pdf" as this and as PNG.

        Returns
        -------
        list of Path : the files

        Raises
        ------
        RacewayError
            A folder that cannot be written, or matplotlib is missing.
        """
        folder = Path(folder)
        paths = [write_json(self.to_dict(), folder / f"{self.stem}.json")]
        texts = self.texts(bool(pictures))
        paths += [write_whole(text.encode(), folder / f"{self.stem}.{suffix}") for suffix, text in texts.items()]
        return paths + (self.picture(folder, "png", *([pictures] if isinstance(pictures, str) else [])) if pictures else [])

    @door
    def picture(self, folder: Annotated[str | Path, PATH], *forms: Annotated[str, TEXT]) -> list[Path]:
        """Draw into a folder, once.

        forms : "png" (default), at 300 dots per inch, "svg", "pdf"

        Returns
        -------
        list of Path : the files; empty where there is nothing to draw

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        from raceway.answers.picture import save_figure

        drawn = self.drawings().items()
        return [save_figure(figure, Path(folder) / f"{name}.{form}") for name, figure in drawn for form in forms or ("png",)]

    @door
    def screen(self, files: Annotated[Iterable[str], TEXTS] = ()) -> RenderableType:
        """The report on a terminal, the written files below it."""
        from rich.console import Group

        from raceway.answers.table import Words, file_lines, rows_table

        words = [Words(part) if isinstance(part, str) else part for part in self.report()]
        parts = [rows_table(part) if isinstance(part, list) else part for part in words]
        return Group(*parts, *file_lines(list(files)))


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during long work; ``partial`` is the answer so far, None where nothing is finished."""

    def __init__(self, partial: Answer | None) -> None:
        super().__init__()
        self.partial = partial
