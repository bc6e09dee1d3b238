"""An end to a search for motions that is no failure of one: a search tries elsewhere where a motion is not found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Stopped(Exception):
    """Carries what a watch raised through the tries of a search."""

    def __init__(self, cause: Exception) -> None:
        super().__init__(str(cause))
        self.cause = cause


def stopping(watch: Callable[[], object]) -> Callable[[], None]:
    """The same watch, whose errors no try of the search takes for its own."""

    def watched() -> None:
        try:
            watch()
        except Exception as why:
            raise Stopped(why) from why

    return watched


@contextmanager
def passed_on() -> Iterator[None]:
    """What a watch raised inside is raised as it was."""
    try:
        yield
    except Stopped as stop:
        raise stop.cause from None
