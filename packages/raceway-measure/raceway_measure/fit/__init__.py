"""Numbers from measured data: ``raceway fit`` (numbers of a scene or a linear model) and ``raceway identify`` (K and C of a bearing in a rig).

fit, identify    the public functions, and both from texts;  fitted, identified: their answers;  picture: figures of both
signals          records and tables in files or in memory;  column_headers: names of a record's columns
response         frequency response functions in universal files
shaft_angle      angle of the shaft from keyphasor pulses or speed;  synchronous: 1x component over speed, run-out
estimate         free and uncertain numbers, least squares, confidence region, combinations that the data do not determine
rig              from the 1x response at the sensor to the bearing: by inversion, by a fit
table            fit to measured K, C, displacements over keys of the scene
linear           K, C, mass from force and displacement;  spectra: of such a record, with hum and aliasing
"""
