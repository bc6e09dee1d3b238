"""The scene: what the user said.

scene       the scene as a frozen tree of attrs objects, SI
bearing     its table [bearing];  sets: rows of balls by their names and one by one;  tables: its other tables
inputs      a scene as it was handed in: file, text, dict or Scene, with changes
changes     ``--set`` changes of plain tables; keys whose numbers can change a little
reading     plain tables to a scene: presets, materials, plug-ins that it requires
structure   plain tables to attrs objects, strictly, every mistake with its path
units       numbers given as text with a unit
schema      JSON schema of a scene file
catalogue   bearing presets and materials by name
designation  makers' designations: angle, clearance, class, ceramic balls, what is ignored
clearance   radial internal clearances of ISO 5753-1 by class and bore
ratings     load ratings of the rows: by keys, as the catalogue prints them, or from geometry
lubricant   oils, their viscosity, and the table [lubricant]
heat        the table [heat]: what carries the heat of friction off
tolerance   ranges of numbers: the table [tolerances], classes of ISO 492 and ISO 3290
unused      keys without effect, and those that a change makes so
growth      of the grooves by speed, fits and temperatures; mass, inertia and shoulders of the rings
"""
