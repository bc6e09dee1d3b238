"""What this package adds to ``raceway``: the catalogue searched and drawn, balls and grooves inferred from print."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (
            rw.Command(
                "catalogue",
                "raceway_catalogue.catalogue:look_up",
                "List, search and draw the bearings of the catalogue.",
                'raceway catalogue "70*C"\nraceway catalogue 7014C --picture 7014C.png',
                {"pattern": rw.Option(positional=True), "picture": rw.Option(metavar="FILE.png")},
                folder=None,
                pictures=None,
            ),
            rw.Command(
                "catalogue --infer",
                "raceway_catalogue.infer:infer_texts",
                "Infer balls and grooves from printed dimensions and ratings.",
                'raceway catalogue --infer --bore "70 mm" --outer-diameter "110 mm" \\\n'
                '    --rating "15:47 kN:43 kN" --rating "25:44.5 kN:41 kN"\n'
                "raceway catalogue --infer nsk --conformity 0.522",
                {
                    "table": rw.Option(positional=True),
                    "ratings": rw.Option("rating", "ANGLE:C:C0"),
                    "pairs": rw.Option("pair", "ANGLE:PRELOAD:STIFFNESS"),
                    **rw.Option.metavars(
                        bore="LENGTH", outer_diameter="LENGTH", width="LENGTH", maker="NAME", conformity="F"
                    ),
                },
                folder=None,
                pictures=None,
            ),
        )
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    return {
        "catalogue": "raceway_catalogue.catalogue",
        "infer": "raceway_catalogue.infer",
        "Inferred": "raceway_catalogue.inferred",
    }
