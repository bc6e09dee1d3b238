"""The scene: what the user said.

scene       the scene as a frozen tree of attrs objects, SI
bearing     its table [bearing];  sets: rows of balls by their names and one by one;  tables: its other tables
given       a scene as the user gave it: file, text, dict or Scene, with changes
file        a TOML file to plain tables, or to a scene;  changes: ``--set`` changes of plain tables
reading     plain tables to a scene;  presets: [bearing] with the numbers of presets and materials
structure   plain tables to attrs objects, strictly, every mistake with its path
units       numbers given as text with a unit
schema      JSON schema of a scene file
continuous  keys whose numbers can change a little, and scenes where one has
catalogue   bearing presets
materials   materials of rings and balls by name
tolerance   ranges of numbers: the table [tolerances];  tolerance_class: those of ISO 492 and ISO 3290 by name
requires    plug-ins that a scene needs
rig         a test rig around the bearing
unused      keys without effect, and those that a change makes so
inner_ring  mass, inertia and growth of the inner ring from its dimensions;  growth: of the grooves, by speed, fits, temperatures
"""
