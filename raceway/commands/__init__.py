"""What the commands share; the only place that prints or exits.

frame          options, progress, writing and showing of results
inputs         scenes, result folders, plug-ins that a command starts from
console        messages and exit codes
interrupt      Ctrl-C, SIGTERM and SIGHUP
streams        standard streams that are closed, or know ASCII only
progress       the bar on standard error;  verbose: what -v tells
reports        reports that ``raceway run`` writes beside result.json
failure        files of a run that failed
cache          ``raceway cache``
new_scene      ``raceway new-scene``
plugins        ``raceway plugins``, ``check-plugin``, ``new-plugin``, ``schema``;  plugin_screen: what they print
screen         tables of a run, a plan and the caches
"""
