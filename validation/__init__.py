"""What tests and measurements share; imports the package, neither of them.

reference     the same physics by independent code: rings, contacts, elastic bodies, friction
scenes, tables, several, random choice of scenes, models built from them
<<<<<<< HEAD
equilibria, tangent, ball_pass, gyroscopic, orders, expected_values, identified_stiffness, error_estimate, series_errors: numbers with their true values
=======
equilibria, tangent, orders, expected_values, identified_stiffness, error_estimate, series_errors, start_errors: numbers with their true values
>>>>>>> 9587d9e6 (Claims: observed orders, identified stiffness and stated errors are two modules of tests instead of four reports of 109 rows)
block, cubes, groove, below_groove, single, squeezed, hexahedron: small bodies and contacts
system_libraries  tests whose system libraries are missing: skipped loudly, or failures
command_line, browser, cluster, sessions, harm, article_study: commands, pages, workers, processes, damaged files
"""
