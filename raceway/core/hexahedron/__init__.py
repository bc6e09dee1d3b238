"""The eight-node hexahedron: forces, matrices, masses and steps of elastic bodies.

operator     HexOperator: one mesh with its material, the face of this package
shape        shape functions, Gauss rules, mean gradients by numpy
modes        an element's fields as sums of its eight modes, in scalars
one_point    the fast kernel: exact mean gradient, hourglass control and its energy, blocks of 16
ranges       the division of a mesh into parts, their sum, the central-difference update
strain       strain-displacement matrices of all four formulations
stiffness    element stiffness matrices and their sum
point_force  internal force of the eight-point formulations
recovery     stresses, von Mises and largest shear stress
stress_fit   stresses between the elements' centres
sparse       sparse matrices of a mesh
block_rows   its stiffness times the displacements of many copies at once
mass         lumped and consistent masses
stable       the stable step from element eigenvalues
"""
