"""The shared finite elements: meshes, hexahedra, condensation, elastic bodies in full.

mesh           hexahedral meshes of rings and balls
hexahedron     the eight-node hexahedron
revolution     compliances of bodies of revolution, harmonic by harmonic
structural     structural compliances behind contact resultants;  calibration: of their contacts, by pressures at points
patches        pressures at surface points on condensed bodies
elastic        every node of rings and balls an unknown
"""
