"""Elastic rings and balls reduced to compliances behind contact resultants.

line_load       the Hertz pressure as a line load on a groove, and on the half-space
structural      structural compliances of rings: finite elements less the half-space that Hertz's formula has
calibration     structural compliance of one contact from pressures at its surface points
elastic_bodies  compliances of a bearing's rings and balls, and the compiled system with them
modes           first natural frequencies of the rings
"""
