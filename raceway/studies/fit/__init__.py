"""``raceway fit``: numbers of a scene, or of a linear model, from measured data.

front           ``raceway.fit``;  fitted: its answer;  command, screen: ``raceway fit``;  picture: data, fit, residuals, region
free            the numbers that are free, with their ranges
uncertain       numbers that are not free, and by how much they may be off
estimate        least squares, confidence region, combinations that the data do not determine
kinds           fits by kind of data;  data: which kind it is
rig_line        the rig's line at its sensor beside a record's;  linear: K, C, mass from force and displacement
disturbed       what disturbs such a record: hum, coloured noise, a force sampled without a filter
observed        a table of measured K, C, displacements over keys of the scene;  predicted: the scene's answers beside it
"""
