"""The catalogue of bearings, and balls and grooves inferred from what a maker prints.

catalogue            ``raceway.catalogue``: bearings listed, searched, one in full, and the command; its section in proportion
printed              what makers print, and tables of it
rating_conventions   load ratings of ISO 281 and ISO 76, and how makers rate: by the standards' tables, or by their own grooves; candidates of ball count and diameter
deep_groove          candidates of deep-groove bearings: one rating, and the factor f_0 where it is printed
inferred             from printed numbers to balls and grooves, each number with scatter and reason
infer                ``raceway.infer``, and tables of many bearings; ``raceway catalogue --infer``
plugin               what this package adds to ``raceway``;  data: printed tables
"""
