"""Pictures of a bearing.

bodies     triangles of rings, balls and grooves; the bearing of one state: arrows, contact ellipses
pictures   the bearing cut open, labels, the most loaded ball in section
stress     displacement and stress fields of elastic bodies, close up below the contacts
page       the page with WebGL
view       ``raceway.view``: the states of a result that are drawn, the files, the answer
mesh       ``raceway view --mesh``: counts, quality, files, picture;  mesh_summary: its numbers
system_libraries   what pyvista needs of the system
plugin     what this package adds to ``raceway``
data       scripts of the page
"""
