"""Trust.

precision   ``raceway precision``: error against run time
stability   ``raceway stability``: stiff and extreme cases
verify      ``raceway verify``: published reference cases
plugin      what this package adds to ``raceway``
data        the cases
"""
