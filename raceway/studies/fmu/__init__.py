"""A bearing as an FMU (Functional Mock-up Unit, FMI 2.0 and 3.0) for simulators.

chebyshev   series of several quantities over a box of inputs, with their error at points that no fit used
map         K, C, or any quantity of ``raceway.function``, over keys of a scene
export      ``raceway.export_fmu``, the front of ``raceway export --fmu``
unit        the files of an FMU: description of its variables, C sources (``raceway/data/fmu``), binary where a compiler exists
"""
