"""Structured meshes of rings and balls, and what every mesh is judged by.

hex_mesh    points, cells, sets of nodes and facets; shape functions, Gauss rules, mean gradients by numpy; graded points on a line, places of the balls
part_meshes  a ring with the true groove, swept in azimuth: outline, profile, exact section; a ball as a cubed sphere
ring_section  integrals of a section, growth
quality     scaled Jacobian, aspect, skew; refusal of bad cells; cells and bytes before a mesh is made
"""
