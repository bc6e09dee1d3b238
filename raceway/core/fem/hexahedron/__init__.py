"""The eight-node hexahedron: forces, matrices, masses and steps of elastic bodies.

operator     HexOperator: one mesh with its material, the face of this package
strain       strain-displacement matrices of all four formulations; an element's fields as sums of its eight modes
stiffness    stiffness matrices and their sum; internal forces, hourglass control and its energy, stresses at points
rows         a mesh in parts: sums, central-difference update, stable step, stresses; rows of blocks times many copies
"""
