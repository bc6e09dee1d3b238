"""Kinds of bodies, and the bearing that each builds.

rigid        rigid rings and balls: kind and cost (the ring: ``raceway.bodies.rigid_bearing``)
rollers      rigid rings on cylindrical rollers: kind and cost;  roller_bearing: the ring, also at many points
condensed    finite elements reduced to contact compliances: kind and cost;  condensed_bearing: the ring
patch_bearing   condensed bodies with pressures at surface points
elastic      finite elements in full: kind and cost;  elastic_bearing: the ring
elastic_contacts   its contacts in a result;  elastic_stress: those at surface points, shear below them
mesh         meshes of a scene, their size before they are made, whether they fit the bearing
"""
