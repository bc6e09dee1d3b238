"""The command line, the only place that prints or exits.

main       the group of all commands;  console: messages and exit codes;  frame: what commands share
commands   their table;  command: one made from a public function;  completion: of keys of a scene, by the shell
interrupt  Ctrl-C, SIGTERM, SIGHUP, and standard streams that are closed or know ASCII only;  verbose: what -v reports
plan       raceway plan;  failure: files of a failed run
sweep, study, plugins   commands that are more than a front: sweeps, studies; for developers, with caches and a first scene
"""
