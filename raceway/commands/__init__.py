"""The command line: one command a module, what it prints beside it; the only place that prints or exits."""
