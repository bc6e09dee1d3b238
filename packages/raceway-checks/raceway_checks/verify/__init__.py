"""Reference cases: published numbers, closed forms, and this program by two ways.

study   ``raceway verify``: how each case is computed, and its verdict
reference   the cases of sources, and a number beside theirs
"""
