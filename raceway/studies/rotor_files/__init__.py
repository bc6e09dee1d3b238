"""Coefficients of a swept bearing as files: bulk data for Nastran, commands for Ansys, tables of all numbers.

nastran   PBUSH, PBUSHT and TABLED1: the diagonal, over the frequency
ansys     COMBI214: the 2x2 matrices across the axis, over the speed of the shaft
numbers   CSV and JSON: these, and the 5x5 matrices of the equilibria
lost      what a format leaves out, in sentences
file      a file as an object;  front: ``raceway.export_coefficients``
"""
