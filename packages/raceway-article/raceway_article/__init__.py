"""The article's figures 9 to 12 and a verdict on each of its claims, from this program's own runs.

design         settings, speeds, axial loads, the shaft's tilt stiffness; scenes of single points; K and |Z| by setting
rules          the outcome of a rule, and the verdict that follows
claims         the claims, each with its rule, what was computed and the verdict;  courses: what curves do
rows           a curve's points: compiled loop, runs that continue each other, what a ring does where its motion is unstable
trends         quasi-static trends beside an independent solver's
study          all runs, the trend of K with speed one choice swapped at a time: ``article()``
figures        figures 9 to 12;  page: page, tables and pictures on disk, the verdicts on the screen
elastic        the article's own model: elastic bodies at one operating point, beside the others;  elastic_design: its runs
elastic_rows   the numbers of a run, and its differences from another;  elastic_page: page and screen
remaining_time   when its runs will end
front          ``raceway study article``;  plugin: what this package adds to ``raceway``;  data: its scenes
"""
