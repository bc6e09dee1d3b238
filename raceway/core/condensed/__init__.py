"""Condensed bodies: finite elements of rings and balls reduced to what the contacts feel.

line_load    a Hertz line load on a groove, and the half-space's displacement under it
structural   structural compliances of rings by depth matching: what the elements give beyond a half-space
sphere       the same of a ball, from the exact elastic sphere
elastic_bodies  both of a bearing, and the compiled system with them in the place of rigid rings
modes        first natural frequencies of the rings
"""
