"""Linear elasticity of one body.

statics         K u = f with prescribed displacements
dissection      the order in which nodes are eliminated
fronts          elimination down to kept nodes, with fronts of dense matrices
multigrid       one W-cycle of smoothed aggregation, in single precision
aggregates      aggregates of nodes along short edges
blocks          products of sparse matrices of 3x3 blocks
rigid_motions   rigid-body motions: near-nullspace of K
"""
