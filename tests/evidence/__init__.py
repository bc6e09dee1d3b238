"""Claims: what README and docs say in numbers, a module a report (CONTRIBUTING, tests and evidence)."""
