"""Built-in plug-ins beside contact laws and integrators, a folder a kind.

excitations  forces
identifiers  dynamic stiffness from motion
bodies       what rings and balls are made of
quantities   lives, friction, temperatures, films, ball-pass frequencies
meshers      hexahedra of the bodies
executors    processes and clusters for many points
formats      pictures and labelled arrays of one run
system_libraries   system libraries that packages for meshes and pictures need
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl
from raceway.plugins.excitations.harmonic import Bidirectional, RunUp, Unidirectional
from raceway.plugins.excitations.measured_force import Measured
from raceway.plugins.executors.dask import Dask
from raceway.plugins.executors.processes import Processes, Serial
from raceway.plugins.formats.pictures import Pictures
from raceway.plugins.identifiers.one_frequency import Fft1x, ImpedanceFit, SineFit, Tangent
from raceway.plugins.identifiers.order_tracking import OrderTracking
from raceway.plugins.meshers.structured import Structured
from raceway.plugins.quantities.ball_pass import BallPass
from raceway.plugins.quantities.film import FilmParameter, FilmThickness
from raceway.plugins.quantities.friction import Friction
from raceway.plugins.quantities.heat import Temperatures
from raceway.plugins.quantities.life import Life


@hookimpl
def raceway_excitations() -> list[type]:
    return [Unidirectional, Bidirectional, RunUp, Measured]


@hookimpl
def raceway_identifiers() -> list[type]:
    return [Fft1x, SineFit, Tangent, ImpedanceFit, OrderTracking]


@hookimpl
def raceway_bodies() -> list[type]:
    from raceway.plugins.bodies.condensed import Condensed
    from raceway.plugins.bodies.elastic import Elastic
    from raceway.plugins.bodies.rigid import Rigid
    from raceway.plugins.bodies.rollers import CylindricalRollers

    return [Rigid, Condensed, Elastic, CylindricalRollers]


@hookimpl
def raceway_meshers() -> list[type]:
    return [Structured]


@hookimpl
def raceway_formats() -> list[type]:
    return [Pictures]


@hookimpl
def raceway_quantities() -> list[type]:
    return [BallPass, FilmThickness, FilmParameter, Friction, Life, Temperatures]


@hookimpl
def raceway_executors() -> list[type]:
    return [Serial, Processes, Dask]
