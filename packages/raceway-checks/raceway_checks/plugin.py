"""What this package adds to ``raceway``: error against run time, stiff and extreme cases, published reference cases, one contact alone."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Trust": (
            rw.Command(
                "precision",
                "raceway_checks.precision.study:precision",
                "Error against run time of numerical settings.",
                "raceway precision examples/b7206.toml \\\n"
                "    --vary integrator.kind=newmark,central_difference \\\n"
                "    --vary integrator.steps_per_turn=45,90,180,360",
                {
                    "vary": rw.Option(metavar="A.B=X,Y", help="Axis; all combinations are run; without, a default design"),
                    "reference": rw.Option(metavar="A.B=C", help="Key of the reference; without, chosen automatically"),
                    "limit_s": rw.Option("limit", "SECONDS", "Omit settings predicted to take longer."),
                },
                folder="-precision",
                unchecked=True,
            ),
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
        ),
        "dev": (
            rw.Command(
                "law",
                "raceway_checks.law:law",
                "Force, stiffness, damping and energy per cycle of a contact law.",
                "raceway dev law hertz --set contact.damping=300\n"
                "raceway dev law penalty --out raceway-out/penalty\n"
                "raceway dev law film --set contact.viscosity=0.03 \\\n"
                "    --set kinematics.spin_speed_rpm=10000",
                {
                    "name": rw.Option(positional=True),
                    "race": rw.Option(choices=("inner", "outer")),
                    **rw.Option.metavars(ball="NUMBER", amplitude="PART", frequency="HZ"),
                },
                folder=None,
            ),
        ),
    }


@rw.hookimpl
def raceway_names() -> dict[str, str]:
    precision = {"Precision": "raceway_checks.precision.answer", "precision": "raceway_checks.precision.study"}
    return precision | dict.fromkeys(("LawCurves", "law"), "raceway_checks.law")
