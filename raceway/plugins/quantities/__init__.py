"""Quantities of solved points.

life       reference and modified life, equivalent load, static safety
friction   friction torque and power loss by source;  heat: temperatures, and the thermal network
film       film thickness and parameter
ball_pass  ball-pass frequencies
"""
