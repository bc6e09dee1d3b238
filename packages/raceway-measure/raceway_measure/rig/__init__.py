"""``raceway study rig``: the article's test rig, its signals, and what can be read back from them.

signals   the signals; the article's procedure; one cause of error at a time
study     ``raceway study rig``: all speeds and loads, the answer, its figures and page
"""
