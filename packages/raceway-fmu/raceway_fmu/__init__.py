"""A bearing as an FMU (Functional Mock-up Unit, FMI 2.0 and 3.0) for simulators.

map         K, C, or any quantity of ``raceway.function``, over keys of a scene, as Chebyshev series
unit        the files: description of variables, C sources (data), library where a compiler exists
export      ``raceway.export_fmu``, the front of ``raceway export --fmu``
rigid_force  the force of a rigid bearing, at once for all balls
plugin      what this package adds to ``raceway``
data        C sources
"""
