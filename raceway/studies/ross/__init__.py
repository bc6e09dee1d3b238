"""Coefficients for the rotor program ROSS.

sources        2x2 matrices over y, z: rotating force, fixed directions, tangent
coefficients   kyy, kyz, ..., cyy, ... over speed and frequency, from a sweep
file           a file that ROSS reads
reading        interpolation by ROSS 2
table          all of it as an object: the element, the file
front          ``raceway.export_ross``;  command: ``raceway export``;  points: its rows;  screen: what it prints

Files for other programs are made from the same coefficients in ``studies/rotor_files``.
"""
