"""Built-in executors.

serial   in this process
joblib   processes on this machine
dask     workers of a dask scheduler
"""
