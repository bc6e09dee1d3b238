"""Numbers from measured data: ``raceway fit`` (numbers of a scene or a linear model) and ``raceway identify`` (K and C of a bearing in a rig).

fit, identify    the public functions and their answers;  command: their commands;  picture: figures of both
signals          records and tables in files or in memory;  column_headers: names of a record's columns
shaft_angle      angle of the shaft from keyphasor pulses or speed;  synchronous: 1x component over speed, run-out
inversion        from the 1x response at the sensor to force and motion in the bearing
estimate         free and uncertain numbers, least squares, confidence region, combinations that the data do not determine
table            fit to measured K, C, displacements over keys of the scene;  rig: to the rig's 1x response
linear           K, C, mass from force and displacement;  disturbances: hum, coloured noise, aliasing of such a record
"""
