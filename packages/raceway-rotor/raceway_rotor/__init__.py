"""Bearings for rotor programs: coefficients in files, and elements that compute theirs inside ROSS.

sources        2x2 matrices over y, z: rotating force, fixed directions, tangent
coefficients   kyy, kyz, ..., cyy, ... over speed and frequency, from a sweep
ross_file      the file for ROSS, interpolation there, the ROSS that is installed
files          Nastran (PBUSHT), Ansys (COMBI214), CSV and JSON
export         ``raceway.export_ross``, ``raceway.export_coefficients``;  coefficient_file: their answers;  command: ``raceway export``
node_bearing   a bearing as a rotor's node meets it: Z, motion under a load, force of a displacement
bearing        ``raceway.ross.RollingBearing``;  responses: to unbalance and in time, with the stiffness of the rotor's motion
shaft          the shaft of a test rig on two bearings;  rig_table: its table [rig]
plugin         what this package adds to ``raceway``
"""
