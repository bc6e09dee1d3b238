"""``raceway study limits``: the axial loads at which a set's rows lift off, and those that its contacts carry.

study     loads at which something happens, by the axial displacement
command   ``raceway study limits``, with its table
"""
