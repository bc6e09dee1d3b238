"""Built-in reports.

pictures   orbit, spectrum and ball loads as PNG files
drawing    the same on axes of matplotlib;  plot: on new or given ones
labelled   arrays of a run with names and units, as a Dataset of xarray
"""
