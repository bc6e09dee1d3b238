"""What a scene needs, what is left out and why, and what it will cost; ``raceway.planning.plan`` puts it together."""
