"""Reference cases: published numbers, closed forms, and this program by two ways.

study   ``raceway verify``: every case and its verdict
reference   the cases of sources, and a number beside theirs
cases   how each is computed: bearings, impacts of spheres, peak pressures of the article
"""
