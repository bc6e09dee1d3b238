"""The article's figures 9 to 12 and a verdict on each of its claims, from this program's own runs.

design       what is run: settings, speeds, axial loads, the shaft's tilt stiffness; scenes of single points
runs         one curve over speed, and all curves in processes of their own, finished ones kept
curves       the numbers by setting: K and |Z| over speed and axial load, with what failed or is in doubt
rules        what a claim asks of a curve or a surface, as plain functions of numbers
regions      where a rule holds, in words
power_law    what "quadratic" asks: an exponent with its interval
verdict      a verdict and how it follows from a rule's outcomes
claims       the claims, each with its rule, what was computed and the verdict;  claims_rotating: 4 and 6;  claims_axial: 5
expected     the quasi-static trends of an independent solver and the same numbers computed here
causes       direction, amplitude law, ball inertia, bodies and friction swapped one at a time
figures      figures 9 to 12;  panel: their axes
report       the page;  files: page, pictures and tables on disk;  screen: the verdicts
elastic      the article's own model: elastic bodies at one operating point, beside the others
study        all of it: ``article()``;  command: ``raceway study article``
"""
