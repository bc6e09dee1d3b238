"""Types of higher floors by name: contracts say what they are handed, and import nothing of what is built upon them.

Each name stands for the class of the same name in the module beside it; type checkers take it for anything.
"""

from typing import Any, TypeAlias

Bearing: TypeAlias = Any  # raceway.scene.bearing
Scene: TypeAlias = Any  # raceway.scene.scene
Balls: TypeAlias = Any  # raceway.planning.resolve
Motion: TypeAlias = Any  # raceway.planning.resolve
Decisions: TypeAlias = Any  # raceway.planning.resolve
Plan: TypeAlias = Any  # raceway.planning.plan
BuiltBearing: TypeAlias = Any  # raceway.bodies.model, where it is called Bearing
Equilibrium: TypeAlias = Any  # raceway.bodies.model
Model: TypeAlias = Any  # raceway.bodies.model
Simulation: TypeAlias = Any  # raceway.pipeline.simulate
Result: TypeAlias = Any  # raceway.pipeline.result
