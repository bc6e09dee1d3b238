"""Condensed rings and balls whose contacts are pressures at surface points.

build    the system of a scene
report   its results: pressures, resolution of the points, effect of elasticity
"""
