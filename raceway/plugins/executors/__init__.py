"""Built-in executors.

serial   in this process;  processes: others on this machine, by the standard library
joblib   processes on this machine
dask     workers of a dask scheduler
"""
