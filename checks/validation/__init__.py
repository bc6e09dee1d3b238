"""What tests and measurements share; imports the package, neither of them.

reference     the same physics by independent code: rings, contacts, elastic bodies, friction
scenes, tables, several, random choice of scenes, models built from them
equilibria, tangent, ball_pass, gyroscopic, orders, expected_values, identified_stiffness, error_estimate, series_errors: numbers with their true values
cubes, groove, quarter, squeezed, hexahedra: small bodies and contacts
fixtures      what all tests may ask for, and what is looked at in each
figures, records, stores, solids, stability_cases: drawings that overlap, invented records and results, meshes, cases that misbehave
system_libraries  tests whose system libraries are missing: skipped loudly, or failures
command_line, browser, cluster, sessions: commands, pages, workers, processes
"""
