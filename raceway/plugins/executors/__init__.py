"""Built-in executors: this process, processes on this machine, workers of a dask scheduler."""
