"""Files of one run.

pictures   orbit, spectrum, ball loads
labelled   arrays with names, coordinates and units
"""
