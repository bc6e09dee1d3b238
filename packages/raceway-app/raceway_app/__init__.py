"""A local application: a scene as a form, its bearing in three dimensions, its curves.

picture   what a scene shows: the screen of its run, ball loads, orbit, curves over speed and load
worker    a process of its own that computes pictures, and can be stopped
session   one or two scenes, their changes and files; the keys of a scene as fields, from the schema
server    ``raceway app`` and its page: its state, what its buttons do, who may talk to it
plugin    what this package adds to ``raceway``;  data: the page
"""
