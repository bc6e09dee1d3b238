"""What a scene needs, what is left out and why, and what it will cost; nothing is built here.

plan      the plan of a scene; its mistakes and warnings
resolve   the problem of a scene: its tables, and what follows from them, each computed once
parts     balls, bodies, motion and output, each kept or left out with its reason; predicted time of a run, speed of this machine
rules     combinations that cannot run; values that are possible and unlikely
columns   scenes and keys that are solved in columns
"""
