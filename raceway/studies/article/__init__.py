"""The article's figures 9 to 12 and a verdict on each of its claims, from this program's own runs.

design         settings, speeds, axial loads, the shaft's tilt stiffness; scenes of single points; K and |Z| by setting
runs           pieces of work: a curve over speed, the scan of the shaft's tilt stiffness, quasi-static trends; effects of one choice
rules          what a claim requires of a curve or a surface, where it holds, and the verdict that follows
claims         the claims, each with its rule, what was computed and the verdict
figures        figures 9 to 12
page           page, pictures and tables on disk; the verdicts on the screen
study          all of it: ``article()``
elastic        the article's own model: elastic bodies at one operating point, beside the others
elastic_page   its page, pictures and tables
command        ``raceway study article``
"""
