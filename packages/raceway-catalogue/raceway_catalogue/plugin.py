"""What this package adds to ``raceway``: the catalogue searched and drawn, balls and grooves inferred from print."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway import hookimpl

if TYPE_CHECKING:
    from raceway import Command


@hookimpl
def raceway_commands() -> dict[str, tuple[Command, ...]]:
    from raceway import Command, Option

    return {
        "Answers": (
            Command(
                "catalogue",
                "raceway_catalogue.catalogue:look_up",
                "List, search and draw the bearings of the catalogue.",
                'raceway catalogue "70*C"\nraceway catalogue 7014C --picture 7014C.png',
                {"pattern": Option(positional=True), "picture": Option(metavar="FILE.png")},
                folder=None,
                pictures=None,
            ),
            Command(
                "catalogue --infer",
                "raceway_catalogue.infer:infer_texts",
                "Infer balls and grooves from printed dimensions and ratings.",
                'raceway catalogue --infer --bore "70 mm" --outer-diameter "110 mm" \\\n'
                '    --rating "15:47 kN:43 kN" --rating "25:44.5 kN:41 kN"\n'
                "raceway catalogue --infer nsk --conformity 0.522",
                {
                    "table": Option(positional=True),
                    "ratings": Option("rating", "ANGLE:C:C0"),
                    "pairs": Option("pair", "ANGLE:PRELOAD:STIFFNESS"),
                    **Option.metavars(bore="LENGTH", outer_diameter="LENGTH", width="LENGTH", maker="NAME", conformity="F"),
                },
                folder=None,
                pictures=None,
            ),
        )
    }


@hookimpl
def raceway_names() -> dict[str, str]:
    return {
        "catalogue": "raceway_catalogue.catalogue",
        "infer": "raceway_catalogue.infer",
        "Inferred": "raceway_catalogue.inferred",
    }
