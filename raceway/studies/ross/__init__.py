"""Bearings for the rotor program ROSS: coefficients in files, and elements that compute theirs inside ROSS.

sources        2x2 matrices over y, z: rotating force, fixed directions, tangent
coefficients   kyy, kyz, ..., cyy, ... over speed and frequency, from a sweep
file           a file that ROSS reads
reading        interpolation by ROSS 2
table          all of it as an object: the element, the file
installed      the ROSS that is installed
node_bearing   a bearing as a rotor's node meets it: Z, motion under a load, force of a displacement
secant         stiffness that one motion meets
bearing        ``raceway.ross.RollingBearing``;  unbalance, transient: responses with its own amplitude
front          ``raceway.export_ross``;  command: ``raceway export``;  points: its rows;  screen: what it prints

Files for other programs are made from the same coefficients in ``studies/rotor_files``.
"""
