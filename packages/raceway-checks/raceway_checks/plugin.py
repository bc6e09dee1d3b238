"""What this package adds to ``raceway``: stability on stiff and extreme cases, published reference cases."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Trust": (
            rw.Command(
                "stability",
                "raceway_checks.stability.study:stability",
                "Test laws and integrators on stiff and extreme cases.",
                "raceway stability --only chatter",
                {"only": rw.Option(metavar="WORDS"), "every": rw.Option("all")},
                folder="-stability",
                unchecked=True,
                pictures=None,
            ),
            rw.Command(
                "verify",
                "raceway_checks.verify.study:verify",
                "Compare with published reference cases.",
                "raceway verify --only harris-table-6.1 --all",
                {"only": rw.Option(metavar="CASE"), "every": rw.Option("all")},
                folder=None,
                pictures=None,
            ),
        )
    }
