"""Built-in plug-ins.

excitations, measured_force      forces
identifiers, order_tracking      dynamic stiffness from motion
structured_mesh                  hexahedra of the bodies
ball_pass, film, friction, life  quantities: ball-pass frequencies; film parameters; friction torque by source; reference and modified life
heat                             quantities: temperatures, and the thermal network
processes, dask                  executors
pictures, labelled               pictures and labelled arrays of one run
system_libraries                 system libraries that packages for meshes and pictures need
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl
from raceway.plugins.ball_pass import BallPass
from raceway.plugins.dask import Dask
from raceway.plugins.excitations import Bidirectional, RunUp, Unidirectional
from raceway.plugins.film import FilmParameter, FilmThickness
from raceway.plugins.friction import Friction
from raceway.plugins.heat import Temperatures
from raceway.plugins.identifiers import Fft1x, ImpedanceFit, SineFit, Tangent
from raceway.plugins.life import Life
from raceway.plugins.measured_force import Measured
from raceway.plugins.order_tracking import OrderTracking
from raceway.plugins.pictures import Pictures
from raceway.plugins.processes import Processes, Serial
from raceway.plugins.structured_mesh import Structured


@hookimpl
def raceway_excitations() -> list[type]:
    return [Unidirectional, Bidirectional, RunUp, Measured]


@hookimpl
def raceway_identifiers() -> list[type]:
    return [Fft1x, SineFit, Tangent, ImpedanceFit, OrderTracking]


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
