"""Standard streams as they come: closed ones, and consoles that know ASCII only.  Part of ``raceway.cli``."""

from __future__ import annotations

import codecs
import io
import os
import sys

#: What stands for the characters of units and names where a console has none of them.
_PLAIN = {
    "\u00b5": "u",
    "\u03bc": "u",
    "\u00b2": "^2",
    "\u00b3": "^3",
    "\u00b0": " deg",
    "\u00b7": " ",
    "\u2013": "-",
    "\u2026": "...",
}


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(sign, "?") for sign in error.object[error.start : error.end]), error.end


def prepare() -> None:
    """Let every character be written somehow, and what is closed lead nowhere; a terminal without columns has those of any."""
    if os.environ.get("COLUMNS", "").isdigit() and int(os.environ["COLUMNS"]) == 0:
        del os.environ["COLUMNS"]
    codecs.register_error("raceway", _plain)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115  as long as the process lives
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="raceway")
