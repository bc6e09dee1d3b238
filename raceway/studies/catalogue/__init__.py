"""The catalogue of bearings: listed, searched, one of them in numbers and as a section.

front      ``raceway.catalogue``;  command: ``raceway catalogue``
entry      what is told of one bearing
drawing    its section, in proportion
screen     lists and one bearing on the screen
"""
