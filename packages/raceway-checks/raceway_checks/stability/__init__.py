"""Stiff and extreme cases, each with an expectation.

study       cases, their rows, and how they are run: ``raceway stability``
catalogue   all cases and their data
systems     bearings that cases are measured on
motions     steps around the stable limit, conserved energy, impacts, chatter
scenes      extreme scenes with every law and integrator, expected by a law's own force and energy; surface points and full models
elements    finite elements at their worst
"""
