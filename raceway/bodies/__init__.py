"""What rings and balls are made of: the kinds of bodies, and the bearing that each builds.

model        a bearing that was built, as the pipeline calls it, its static state, and everything else that a run computes with
basis        what every kind starts from: geometry, contacts, loads, linear parts of the ring
mounting     preload of a pair, an axial displacement that is held
running      contact laws at the running speed: entraining speeds, loads, parameters that fit the equilibrium
contacts     angles, ellipses and pressures of contact resultants, edges of grooves, error of a contact law
mesh         meshes of a scene, their size before they are made, whether they fit the bearing
rigid        rigid rings and balls: kind and cost;  rigid_bearing: the ring
rollers      rigid rings on cylindrical rollers: kind and cost;  roller_bearing: the ring;  roller_columns: at many points
columns      rigid bodies at many operating points at once
condensed    finite elements reduced to contact compliances: kind and cost;  condensed_bearing: the ring
patch_bearing   condensed bodies with pressures at surface points
elastic      finite elements in full: kind and cost;  elastic_bearing: the ring
elastic_contacts   its contacts in a result;  elastic_stress: shear below them
elastic_change   how much elastic rings and balls change the stiffness of rigid ones, without a mesh
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_bodies() -> list[type]:
    from raceway.bodies.condensed import Condensed
    from raceway.bodies.elastic import Elastic
    from raceway.bodies.rigid import Rigid
    from raceway.bodies.rollers import CylindricalRollers

    return [Rigid, Condensed, Elastic, CylindricalRollers]
