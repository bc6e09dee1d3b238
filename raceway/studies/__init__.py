"""Many runs, or many numbers, made into one answer.  Studies call ``raceway.run`` and the registry, never each other.

reference          the published cases in ``raceway/data/cases.json``
verify             every case against this program's own numbers
verify_bearings, verify_impacts   how a case is computed, by its source
"""
