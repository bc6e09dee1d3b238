"""What this package adds to ``raceway``: stability on stiff and extreme cases, published reference cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway import hookimpl

if TYPE_CHECKING:
    from raceway import Command


@hookimpl
def raceway_commands() -> dict[str, tuple[Command, ...]]:
    from raceway import Command, Option

    return {
        "Trust": (
            Command(
                "stability",
                "raceway_checks.stability.study:stability",
                "Test laws and integrators on stiff and extreme cases.",
                "raceway stability --only chatter",
                {"only": Option(metavar="WORDS"), "every": Option("all")},
                folder="-stability",
                unchecked=True,
                pictures=None,
            ),
            Command(
                "verify",
                "raceway_checks.verify.study:verify",
                "Compare with published reference cases.",
                "raceway verify --only harris-table-6.1 --all",
                {"only": Option(metavar="CASE"), "every": Option("all")},
                folder=None,
                pictures=None,
            ),
        )
    }
