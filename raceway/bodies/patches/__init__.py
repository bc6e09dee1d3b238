"""Condensed rings and balls whose contacts are pressures at surface points.

plan     number of points, memory and time
build    the bearing of a scene
report   its results: pressures, resolution of the points, effect of elasticity
"""
