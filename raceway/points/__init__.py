"""One scene at many points: branches of steady orbits over a key, and one contact's law over approaches.

follow, continuation, parameter, branch, attractor    ``raceway.follow``: the branch of steady orbits over a continuous key
law    ``raceway.law``: one contact of a bearing with any installed contact law, beside Hertz'
"""
