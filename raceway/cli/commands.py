"""The table of commands, by what they are for.  A front's module is imported when its command is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import NamedTuple

import click

from raceway.cli.command import Command, Option
from raceway.framework.loading import available, named, packages


class Later(NamedTuple):
    """A command that computes no answer: the click command at "module:name"."""

    name: str
    place: str
    summary: str
    aliases: tuple[str, ...] = ()

    def click(self) -> click.Command:
        command: click.Command = named(self.place)
        return command


_VARY = Option(
    metavar="A.B=X,Y", help="Values x,y,z or a range start:stop:count of a key, all combinations of which are run."
)

ANSWERS: tuple[Command | Later, ...] = (
    Command(
        "run",
        "raceway.pipeline.front:run",
        "Compute one scene.",
        "raceway run examples/b7206.toml --pictures \\\n    --set excitation.speed_rpm=15000 --set supports.tilt=free",
        {"reports": Option("report", "NAME"), "patience": Option(metavar="FACTOR")},
        pictures=False,
    ),
    Command(
        "plan",
        "raceway.cli.plan:plan",
        "Validate a scene; predict its size, time and memory.",
        "raceway plan examples/b7206.toml --set supports.tilt=free",
        folder=None,
        pictures=None,
        aliases=("check",),
    ),
    Command(
        "compare",
        "raceway.points.compare:compare",
        "Vary keys of a scene; report the effect of each.",
        "raceway compare examples/b7206.toml \\\n"
        "    --vary excitation.kind=unidirectional,bidirectional \\\n"
        "    --vary excitation.speed_rpm=10980:15000:5",
        {"vary": _VARY},
        folder="-compare",
        unchecked=True,
    ),
    Command(
        "sweep",
        "raceway.cli.sweep:sweep",
        "Compute many operating points; parallel, resumable.",
        "raceway sweep examples/b7206.toml --plot K \\\n"
        "    --grid excitation.speed_rpm=10980:15000:9 --grid load.axial=400,1200\n"
        "raceway sweep raceway-out/B7206C-sweep --plot p0 --at load.axial=1200\n"
        "raceway sweep examples/steady_orbit.toml --design sobol:1024 \\\n"
        "    --range load.axial=400:2000 --range rotor.mass=1:3\n"
        "raceway sweep examples/steady_orbit.toml --list points.csv \\\n"
        "    --executor processes --workers 4",
        {
            "source": Option(metavar="SCENE|STORE", positional=True),
            "axes": Option("grid", "A.B=X,Y"),
            "points": Option("list", "FILE"),
            "ranges": Option("range", "A.B=X:Y"),
            "quantities": Option("quantity", "NAME"),
            "settings": Option("set", "A.B=C"),
            "store": Option("out", "STORE"),
            "value": Option("plot", "NAME"),
            "kind": Option(choices=("curves", "map", "surface")),
            **Option.metavars(design="KIND:N", seed="N", workers="N", executor="NAME", scheduler="ADDRESS"),
            **Option.metavars(x="KEY", y="KEY", at="KEY=VALUE", picture="FILE"),
        },
        folder=None,
        pictures=None,
        remaining=True,
    ),
    Command(
        "follow",
        "raceway.points.follow:curve",
        "Continue K over speed or another key, through folds, with stability.",
        "raceway follow examples/b7206.toml --over excitation.speed_rpm=500:30000\n"
        "raceway follow examples/b7206.toml --over load.axial=2000:100 \\\n"
        "    --set supports.tilt=free",
        {
            "over": Option(metavar="A.B=FIRST:LAST", help="Continuous key that the steady orbit is followed over."),
            "aim": Option(metavar="PART"),
            "turns": Option(metavar="N"),
        },
        folder="-follow",
        unchecked=True,
    ),
    Command(
        "band",
        "raceway.points.band:uncertainty",
        "Derivatives of the answer; 95 % band over tolerances.",
        "raceway band examples/b7206.toml --by bearing.contact_angle_deg\n"
        'raceway band examples/minimal.toml --tolerance load.axial="±10 %" \\\n'
        '    --tolerance bearing.contact_angle_deg="±1 deg" --samples 512',
        {
            "tolerances": Option(
                "tolerance", "A.B=TEXT", "'±10 %', '±1 deg', '+2 µm -1 µm', class=P4, balls=G5 [the scene's tolerances]"
            ),
            "keys": Option("by", "A.B", "Derivatives by this key only [every number of the scene]"),
            "samples": Option(metavar="N"),
            "processes": Option(default=2),
        },
        folder="-band",
        aliases=("sensitivities",),
    ),
)
DEVELOPERS = (
    Later("new-plugin", "raceway.cli.plugins:new_plugin_command", "Write a package for a new plug-in."),
    Later("check-plugin", "raceway.cli.plugins:check_plugin", "Test a plug-in against its contract."),
    Later("schema", "raceway.cli.plugins:schema", "JSON schema of a scene."),
    Later("cache", "raceway.cli.plugins:cache", "List or clear the caches."),
    Later("plugins", "raceway.cli.plugins:plugins", "List installed plug-ins and their options."),
    Later("new-scene", "raceway.cli.plugins:new_scene", "Write a scene to start from."),
)
#: Heading in --help -> its commands.
SECTIONS: dict[str, tuple[Command | Later, ...]] = {
    "Answers": ANSWERS,
    "Studies": (Later("study", "raceway.cli.main:study", "Whole studies that end in a page, and others' studies."),),
    "Developers": (Later("dev", "raceway.cli.main:dev", "Plug-ins: templates, conformance, laws, schema, caches."),),
}


def listed_commands() -> Iterator[tuple[str, str, str]]:
    """Heading, name and summary of each command that is installed beside ``raceway``'s own; those of third parties alone are imported."""
    for package, has in packages().items():
        if available(package):
            parted = ((name, text.partition(": ")) for name, text in has["commands"].items() if text)
            yield from ((heading, name, summary) for name, (heading, _, summary) in parted)
    if any(getattr(point.dist, "name", "") not in packages() for point in entry_points(group="raceway")):
        from raceway.framework.loading.registry import default_registry

        own = {name for has in packages().values() for name in has["commands"]}
        for heading, commands in default_registry().mapping("raceway_commands").items():
            yield from ((heading, about.name, about.summary) for about in commands if about.name not in own)
