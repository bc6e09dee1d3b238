"""Pictures of a bearing.

labels        ball loads beside their arrows
states        states of a result that are drawn
surfaces      triangles of rings, balls and grooves
bearing       rings, balls, arrows and contact ellipses of one state
scene         the bearing, drawn by pyvista
contacts      the most loaded ball in section
page          the page with WebGL
front         ``raceway.view``;  view: its answer
fields        displacement and stress fields of elastic bodies
contact_stress  stresses below the most loaded contacts, close up
study         the files of one result;  command: ``raceway view``
mesh_command  ``raceway mesh``;  mesh_picture, mesh_screen: its picture and table
"""
