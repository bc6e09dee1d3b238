"""Stiff and extreme cases, each with an expectation.

case, catalogue   cases and what is expected;  extremes: their data
systems           systems that cases are measured on
energy            conserved energy, impacts, chatter
limits            steps around the stable limit
scenes            extreme scenes with every law and integrator
own_force         force function of a law: approaches and slopes by its inverse
stored            energy stored in contacts and bodies
elastic           cases of full models;  surface: of surface points;  elements: of finite elements
workers           cases in processes
study             the whole catalogue;  command: ``raceway stability``
picture, screen   its page and table
"""
