"""Excitations.

harmonic        along one direction, turning with the rotor, turning while the speed changes, loads of whirling
measured_force  a force from a file
"""
