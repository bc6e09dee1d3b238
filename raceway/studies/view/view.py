"""The answer of ``raceway.view``: pictures, in memory and as files."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import SceneError
from raceway.framework.shown import Fact, Shown, largest_facts
from raceway.plugins.pictures import given_axes
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@attrs.frozen(eq=False, repr=False, slots=False)
class View(Shown):
    """Pictures of one bearing.

    Attributes
    ----------
    content : what is shown: the largest load [N] and pressure [Pa], warnings
    pictures : name -> content of the file

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.view({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> found.pictures["bearing.png"][:4], found.files
    (b'\\x89PNG', [])
    """

    content: Tables
    pictures: dict[str, bytes]

    @property
    def files(self) -> list[Path]:
        """What was written; empty where no folder was given."""
        return [Path(name) for name in self.content["files"]]

    def save(self, folder: str | Path) -> list[Path]:
        """Write all pictures into a folder.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return [write_whole(content, Path(folder) / name) for name, content in self.pictures.items()]

    def to_dict(self) -> Tables:
        """What is shown, as plain tables; the pictures by their files."""
        return dict(self.content)

    def plot(self, name: str = "bearing.png", ax: Axes | None = None) -> Axes:
        """Put one picture on matplotlib axes.

        Parameters
        ----------
        name : of a PNG file among ``pictures``
        ax : axes; new ones without

        Raises
        ------
        SceneError
            No such picture.
        """
        known = [one for one in self.pictures if one.endswith(".png")]
        if name not in known:
            raise SceneError.at("name", name, f"must be one of {', '.join(known)}")
        from matplotlib.image import imread

        axes = given_axes(ax, 8.0, 6.0)
        axes.imshow(imread(io.BytesIO(self.pictures[name])))
        axes.set_axis_off()
        return axes

    def _shown(self) -> tuple[str, list[Fact]]:
        shown = self.content
        facts = [*largest_facts(shown, shown["shown"]), ("pictures", "", ", ".join(self.pictures))]
        where = [("written", "", str(path)) for path in self.files] or [("in memory", "", "save(folder) writes them")]
        return shown["title"], [*facts, *where, *(("warning", "", text) for text in shown["warnings"])]

    def _repr_html_(self) -> str:
        image = base64.b64encode(self.pictures["bearing.png"]).decode()
        picture = f'<img style="max-width:100%" alt="the bearing cut open" src="data:image/png;base64,{image}"/>'
        return f"{picture}{super()._repr_html_()}"
