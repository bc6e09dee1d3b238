"""Trust.

precision   ``raceway precision``: error against run time
stability   ``raceway stability``: stiff and extreme cases
verify      ``raceway verify``: published reference cases
law         ``raceway dev law``: one contact of a bearing, alone
clocks      time and memory of a process
plugin      what this package adds to ``raceway``
data        the cases
"""
