"""Built-in plug-ins, one a file in a folder for each kind.

excitations, identifiers, meshers, formats, reports, executors
system_libraries   system libraries that packages for meshes and pictures need
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl
from raceway.plugins.excitations.bidirectional import Bidirectional
from raceway.plugins.excitations.measured import Measured
from raceway.plugins.excitations.run_up import RunUp
from raceway.plugins.excitations.unidirectional import Unidirectional
from raceway.plugins.executors.dask import Dask
from raceway.plugins.executors.joblib import Joblib
from raceway.plugins.executors.processes import Processes
from raceway.plugins.executors.serial import Serial
from raceway.plugins.formats.abaqus import Abaqus
from raceway.plugins.formats.msh import Msh
from raceway.plugins.formats.vtu import Vtu
from raceway.plugins.identifiers.fft_1x import Fft1x
from raceway.plugins.identifiers.impedance_fit import ImpedanceFit
from raceway.plugins.identifiers.order_tracking import OrderTracking
from raceway.plugins.identifiers.sine_fit import SineFit
from raceway.plugins.identifiers.tangent import Tangent
from raceway.plugins.meshers.file import File
from raceway.plugins.meshers.gmsh import Gmsh
from raceway.plugins.meshers.structured import Structured
from raceway.plugins.reports.pictures import Pictures


@hookimpl
def raceway_excitations() -> list[type]:
    return [Unidirectional, Bidirectional, RunUp, Measured]


@hookimpl
def raceway_identifiers() -> list[type]:
    return [Fft1x, SineFit, Tangent, ImpedanceFit, OrderTracking]


@hookimpl
def raceway_meshers() -> list[type]:
    return [Structured, File, Gmsh]


@hookimpl
def raceway_formats() -> list[type]:
    return [Vtu, Abaqus, Msh]


@hookimpl
def raceway_reports() -> list[type]:
    return [Pictures]


@hookimpl
def raceway_executors() -> list[type]:
    return [Serial, Processes, Joblib, Dask]
