"""Stiff and extreme cases, each with an expectation.

case, catalogue   cases and their rows;  extremes: their data
systems           systems that cases are measured on
energy            conserved energy, impacts, chatter
limits            steps around the stable limit
scenes            extreme scenes with every law and integrator
own_force         force function of a law: approaches and slopes by its inverse
stored            energy stored in contacts and bodies
surface, elastic, elements    surface points, full models, finite elements
study             runs them;  command: ``raceway stability``
picture, screen   its page and table
"""
