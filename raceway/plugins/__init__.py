"""Built-in excitations, identifiers, meshers, formats and reports, one a file in a folder for each kind."""

from __future__ import annotations

from raceway.hookspecs import hookimpl
from raceway.plugins.excitations.bidirectional import Bidirectional
from raceway.plugins.excitations.unidirectional import Unidirectional
from raceway.plugins.identifiers.fft_1x import Fft1x
from raceway.plugins.identifiers.sine_fit import SineFit
from raceway.plugins.identifiers.tangent import Tangent
from raceway.plugins.reports.pictures import Pictures


@hookimpl
def raceway_excitations() -> list[type]:
    return [Unidirectional, Bidirectional]


@hookimpl
def raceway_identifiers() -> list[type]:
    return [Fft1x, SineFit, Tangent]


@hookimpl
def raceway_reports() -> list[type]:
    return [Pictures]
