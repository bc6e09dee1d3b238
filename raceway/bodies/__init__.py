"""The bearing as it is built and mounted, whatever its bodies are made of: what every kind of bodies shares.

model        a bearing that was built, as the pipeline calls it, its static state, and everything else that a run computes with
basis        what every kind starts from: geometry, contacts, loads, linear parts of the ring
mounting     preload of a pair, an axial displacement that is held
running      contact laws at the running speed: entraining speeds, loads, parameters that fit the equilibrium
contacts     angles, ellipses and pressures of contact resultants, edges of grooves, error of a contact law
rigid_bearing   rigid rings and balls at one point;  columns: at many operating points at once, from a plan
"""
