"""Relative errors of Z, each with how it was estimated.

estimate         the table ``error`` of a result
finer_series     harmonics beyond the samples of a series of equilibria
free_vibration   Z without the free vibration of a transient
steady_motion    distance from the steady motion
other_start      with friction: the same motion from another start
series           errors at each speed of a run-up
hypotheses       spread over the hypotheses left at their defaults
misfit           a K and C of several whirl speeds against Z at each of them
"""
