"""Executors of many points.

processes   on this machine
dask        workers of a scheduler
"""
