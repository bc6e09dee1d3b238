"""``raceway band``: the range of an answer over the tolerances of its scene, and which of them causes it.

sobol       quasi-random samples, quantiles, first-order and total Sobol indices of any function of independent numbers
study       samples of a scene, computed in chunks that are kept, and their band;  front: ``raceway.band``
command     ``raceway band``, with its table;  picture: histograms and bars of indices
"""
