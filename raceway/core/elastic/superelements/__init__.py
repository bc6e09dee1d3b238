"""Superelements of a ball bearing in nodal contact: every body is eliminated once, down to the nodes that contacts may touch.

part        one mesh, factored for all its copies
loose       copies that share no node: balls, or a ring as a whole
closed      sectors that make up a ring, harmonic by harmonic
balls       equal balls with their cage
rings       a ring and the frame that it is fastened to
ring_flexibility    what forces at some contacts' nodes of the rings do there
tangent     contacts' tangents of one ball
pressing    the contacts' forces during a step
interface   all bodies, seen from the nodes of their contacts
linearised  all bodies and the tangents of their contacts, factored
kept        superelements of large parts on disk
bearing     the superelements of a bearing, made from its assembly
solver      Newton's method in the contacts alone
"""
