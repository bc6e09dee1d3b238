"""Error against run time.

study      ``raceway precision``: settings of a scene and their references, run
answer     settings beside their references, the cheapest ones, orders
settings   what is run, and the reference
timing     runs with their time and memory
picture    page, and the picture of error against run time
"""
