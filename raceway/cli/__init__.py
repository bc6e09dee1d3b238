"""The command line, the only place that prints or exits.

main       the group of all commands, and of studies;  console: messages and exit codes;  frame: what commands share,
           with what -v reports, keys that the shell completes, and files of a failed run
commands   their table;  command: one made from a public function
interrupt  Ctrl-C, SIGTERM, SIGHUP, and standard streams that are closed or know ASCII only
plan       raceway plan
schema     JSON schema of a scene file
sweep, plugins   commands that are more than a front: sweeps; for developers, with caches and a first scene
"""
