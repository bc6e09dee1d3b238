"""One scene, some keys varied, everything else the same: effects in words."""
