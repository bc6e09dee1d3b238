"""Structured meshes of rings and balls, and what every mesh is judged by.

hex_mesh      points, cells, sets of nodes and facets
spacing       graded points on a line
ring_mesh     a ring with the true groove, swept in azimuth
ring_shape    profile of a ring from the dimensions of a scene
ring_section  exact section of an inner ring: inertia, growth by rotation
outline       outline of a section without the groove, plain or from a polygon
ball_mesh     a ball as a cubed sphere
place         places of the balls in the bearing
quality       scaled Jacobian, aspect, skew; refusal of bad cells
size          cells and bytes, before a mesh is made
summary       counts and quality as plain numbers
"""
