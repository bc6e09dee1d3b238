"""Published results, one file a source: frame, normalisation and the tolerance with its reason at the top."""
