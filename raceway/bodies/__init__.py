"""What rings and balls are made of: a folder a kind, each with its plan, its build and its report.

rigid, condensed, elastic   kinds of plug-in ``bodies``;  patches: contacts of condensed bodies at surface points
model        a bearing that was built, as the pipeline asks it, and everything else that a run computes with
basis        what every kind starts from: geometry, contacts, loads, linear parts of the ring
mounting     preload of a pair, an axial displacement that is held
running      contact laws at the running speed: entraining speeds, loads, parameters that fit the equilibrium
equilibrium  the static state;  grooves: angles and edges of contacts;  pressure: of contact resultants
contact_error   of laws that are not calibrated: against Hertz, or the overlap that they leave
modules      optional modules that these bodies import
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
