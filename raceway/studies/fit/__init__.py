"""Numbers from measured data: ``raceway fit`` (numbers of a scene or a linear model) and ``raceway identify`` (K and C of a bearing in a rig).

fit, identify    the public functions;  command: their commands;  fitted: the answer of a fit;  picture: figures of both
signals          records and tables in files or in memory;  column_headers: names of a record's columns
shaft_angle      angle of the shaft from keyphasor pulses or speed;  synchronous: 1x component over speed, run-out
identification   from the 1x component at the sensor to force, motion, K and C of the bearing
estimate         free and uncertain numbers, least squares, confidence region, combinations that the data do not determine
table            measured K, C, displacements over keys of the scene, compared with the scene's answers
rig              the rig's 1x component compared with the record's
linear           K, C, mass from force and displacement;  disturbances: hum, coloured noise, aliasing of such a record
"""
