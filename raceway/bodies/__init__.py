"""What rings and balls are made of: a folder a kind, each with its plan, its build and its report.

rigid, condensed, elastic   kinds of plug-in ``bodies``;  patches: contacts of condensed bodies at surface points
model        everything that a run computes with;  bearing: what the pipeline asks of a bearing, whatever its bodies
basis        what every kind starts from: geometry, contacts, loads, linear parts of the ring
mounting     preload of a pair, an axial displacement that is held
equilibrium  the static state;  pressure: of contact resultants;  contact_error: what a law itself is off by
meshing      the meshes of a scene;  mesh_plan: their size before they are made;  mesh_fit: do they fit the bearing
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_bodies() -> list[type]:
    from raceway.bodies.condensed.kind import Condensed
    from raceway.bodies.elastic.kind import Elastic
    from raceway.bodies.rigid.kind import Rigid

    return [Rigid, Condensed, Elastic]
