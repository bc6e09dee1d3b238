"""Tests of what measures: reports, documents, faults, fuzzing, comparisons with other programs."""
