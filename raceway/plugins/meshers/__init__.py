"""Built-in meshers.

structured   rings with the true groove, balls as cubed spheres, graded to the contacts
file         meshes from files
gmsh         solids meshed by Gmsh
"""
