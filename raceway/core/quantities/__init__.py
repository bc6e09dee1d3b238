"""Numerics of the quantities beside K: lives, friction, temperatures.

ratings    load ratings of ISO 281 and ISO 76, and the contact loads that they stand for; reference life of ISO/TS 16281, modified life
rolling_friction  losses of balls in contacts and mixture: inlet, hysteresis, slip, drag;  losses: their compiled loop over points
thermal    steady temperatures of a network of six nodes, and its conductances
"""
