"""Quantities of solved points.

life       reference and modified life, equivalent load, static safety
friction   friction torque and power loss by source, and Palmgren's rule of thumb
heat       temperatures, and the thermal network that they follow from
film       film thickness and parameter
kinematics   ball-pass frequencies, and the traction that rolling balls need
"""
