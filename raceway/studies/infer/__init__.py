"""A bearing's balls and grooves from what its maker prints: dimensions, load ratings, preloads and stiffnesses of pairs.

printed      what makers print, and tables of it
ratings      load ratings of ISO 281 and ISO 76, by their tables and for grooves of any conformity
grooves      Hertz contacts of many grooves at once; axial stiffness of a preloaded pair
ball_sizes   usual ball diameters
practices    how makers rate: by the standards' tables, or by their own grooves; candidates of ball count and ball diameter
inferred     the answer: numbers with scatter and reason
tables       many bearings of one table, and how well the answers meet it
infer        from printed numbers to the answer
front        ``raceway.infer``;  command: ``raceway infer``;  screen: what it prints
"""
