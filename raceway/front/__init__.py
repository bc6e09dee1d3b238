"""What one scene answers, for Python and the command line alike: a scene in any form in, an object out.

run     the result of one run
plan    what would be built, and what not
check   mistakes and warnings of a scene, as an object
evolve  a scene with changes as on the command line
"""
