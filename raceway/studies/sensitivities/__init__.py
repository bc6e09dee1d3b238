"""``raceway sensitivities``: how much each number of a scene changes the answer, by the implicit function theorem.

sensitivities   derivatives by every key, as an object, and its tables
quantities      what of a result is told, and its derivatives
front           ``raceway.sensitivities``;  command, screen: ``raceway sensitivities``;  picture: bars of relative influence
"""
