"""Quantities of solved points.

life       reference and modified life, equivalent load, static safety
friction   friction torque and power loss by source, and Palmgren's rule of thumb;  sliding: traction that rolling balls need
heat       temperatures;  thermal_network: what they follow from
film       film thickness and parameter
ball_pass  ball-pass frequencies
"""
