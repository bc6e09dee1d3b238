"""Bodies whose every node is a degree of freedom.

friction    Coulomb friction at the points of a contact
"""
