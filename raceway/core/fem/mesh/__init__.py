"""Structured meshes of rings and balls, and what every mesh is judged by.

hex_mesh    points, cells, sets of nodes and facets; graded points on a line, places of the balls
ring_mesh   a ring with the true groove, swept in azimuth: outline, profile, exact section;  ring_section: integrals, growth
ball_mesh   a ball as a cubed sphere
quality     scaled Jacobian, aspect, skew; refusal of bad cells; cells and bytes before a mesh is made
"""
