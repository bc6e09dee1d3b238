"""Reference cases: published numbers, closed forms, and this program by two ways.

study     every case;  command: ``raceway verify``
bearings  bearings, through scenes
impacts   impacts of spheres
article   peak pressures of the article
screen    the table
"""
