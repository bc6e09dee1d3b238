"""What a scene needs, what is left out and why, and what it will cost; nothing is built here.

plan      the plan of a scene; its mistakes and warnings
resolve   balls, motion, record and steady orbits that a scene asks for
rules     combinations that cannot run; values that are possible and unlikely
cost      closed formulas for first guesses, predicted time of a run;  machine: speed of this machine
"""
