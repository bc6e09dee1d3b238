"""What this package adds to ``raceway``: coefficients for rotor programs, the bearing inside ROSS."""

from __future__ import annotations

import raceway as rw


@rw.hookimpl
def raceway_commands() -> dict[str, tuple[rw.Command, ...]]:
    return {
        "Answers": (
            rw.Command(
                "export",
                "raceway_rotor.command:export",
                "Export coefficients of a sweep to rotor programs.",
                "raceway export raceway-out/B7206C-sweep --ross bearing.toml \\\n"
                "    --at load.axial=1000\n"
                "raceway sweep examples/b7206.toml --set identifier.kind=tangent \\\n"
                "    --grid kinematics.spin_speed_rpm=0:20000:21 --out raceway-out/from-rest\n"
                "raceway export raceway-out/from-rest --from tangent --ross bearing.toml\n"
                "raceway export raceway-out/from-rest --from tangent \\\n"
                "    --nastran bearing.bdf --ansys bearing.inp --table bearing.csv",
                {
                    "store": rw.Option(positional=True),
                    "source": rw.Option("from", choices=("rotating", "directions", "tangent")),
                    "ross_version": rw.Option(choices=("2", "3")),
                    **rw.Option.metavars(
                        ross="FILE", nastran="FILE", ansys="FILE", table="FILE", at="KEY=VALUE", damping="C", tag="NAME"
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
        "CoefficientFile": "raceway_rotor.coefficient_file",
        "RossTable": "raceway_rotor.coefficient_file",
        "export_coefficients": "raceway_rotor.export",
        "export_ross": "raceway_rotor.export",
        "ross.RollingBearing": "raceway_rotor.bearing",
        "ross.UnbalanceResponse": "raceway_rotor.responses",
        "ross.run_time_response": "raceway_rotor.responses",
        "ross.run_unbalance_response": "raceway_rotor.responses",
    }


@rw.hookimpl
def raceway_tables() -> dict[str, str]:
    return {"rig": "raceway_rotor.rig_table:Rig"}
