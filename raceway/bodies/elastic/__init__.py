"""Rings and balls whose every node is a degree of freedom.

kind         the plug-in;  plan: size and time of its meshes, scenes that it refuses
build        the bearing of a scene
report       its results: reactions, energies, mesh, balance of forces
points       results of contacts at surface points: pressures, overlap
subsurface   stresses below the most loaded contact of each race, beside Hertz's
resultants   results of contacts with one calibrated resultant each
locking      nearly incompressible materials whose elements lock under contacts at surface points
"""
