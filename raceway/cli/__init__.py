"""The command line, the only place that prints or exits.

main       the commands by group;  console: messages and exit codes;  frame: what commands share
interrupt  Ctrl-C, SIGTERM, SIGHUP, and standard streams that are closed or know ASCII only;  verbose: what -v reports
run        reports and files of a failed run;  run_screen, run_parts, plan_screen: tables of a run and a plan
cache, plugins, new_scene   commands for caches, plug-ins and a first scene
"""
