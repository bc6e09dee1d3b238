"""The scene: what the user said.

scene       the scene as a frozen tree of attrs objects, SI, of whatever a user hands in, with changes
bearing     its table [bearing], materials by name;  tables: its other tables
inputs      text of a scene file, plain Python values of what is handed in, `--set` changes of plain tables
keys        numbers of a scene that can change a little
reading     plain tables to those of a scene: presets, materials, plug-ins that it requires
structure   plain tables to attrs objects, strictly, every mistake with its path
units       numbers given as text with a unit
catalogue   bearing presets by name
designation  makers' designations: angle, clearance, class, ceramic balls, what is ignored; clearances of ISO 5753-1; sets of rows of balls
ratings     load ratings of the rows: by keys, as the catalogue prints them, or from geometry
lubricant   oils, their viscosity, and the table [lubricant]
tolerance   ranges of numbers: the table [tolerances], classes of ISO 492 and ISO 3290
unused      keys without effect, and those that a change makes so
growth      of the grooves by speed, fits and temperatures; mass, inertia and shoulders of the rings
"""
