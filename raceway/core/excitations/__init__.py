"""Compiled forces of the built-in excitations; the classes with the options are in ``raceway.plugins.excitations``.

harmonic   turning, or along a fixed direction
run_up     unbalance force under a speed that changes linearly
samples    a measured force, interpolated
"""
