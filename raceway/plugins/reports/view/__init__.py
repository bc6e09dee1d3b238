"""The bearing of a result, drawn: ``raceway view``.

surfaces     triangles of rings, balls, arrows and contact ellipses, in millimetres
bearing      what is drawn of one state: bodies, loads, pressures
scene        the bearing as a picture, off-screen
contacts     section of the most loaded ball and its contact ellipses
animation    a turn as a GIF
page         the same as an HTML page that opens from a file
"""
