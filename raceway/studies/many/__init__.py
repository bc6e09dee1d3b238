"""What studies share.

engine          items in, rows out as they finish, kept and resumed, by any executor;  work: what is sent to its workers
row_store       finished rows on disk, by a key of all that decides them;  identity: versions and plug-ins that do
axes, points    values along keys of a scene, and the scene at one point of them
measured_run    one setting with its cost;  reference: the cases that come with the package;  page: HTML without a network
"""
