"""Built-in formats of hexahedral meshes.

vtu      VTK's unstructured grids
abaqus   input files of Abaqus and CalculiX
msh      mesh files of Gmsh
"""
