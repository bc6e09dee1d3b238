"""Meshes that other programs make.

mesh_files        hexahedra from files, a mesh of each body;  gmsh: from solids
formats, abaqus   mesh files
plugin            what this package adds to ``raceway``
data              a ring as solid and as mesh, for conformance suites
"""
