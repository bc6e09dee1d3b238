"""One scene, some keys varied, everything else the same: effects in words.

front        ``raceway.compare``
study        the runs;  command: ``raceway compare``
findings     rows, effects and trends as numbers
effects      two-level factorial analysis
causes       causes of the change of K(w);  inertia: of the difference between |Z| and K
explain      findings as sentences;  phrases: numbers and lists as words
comparison   all of it as table and files;  picture: K and |Z|;  screen: the table;  labelled: the data set
"""
