"""Counts what the matrix ran and what was refused, and prints it at the end."""

from collections import Counter

KEY = "raceway_matrix"


def pytest_terminal_summary(terminalreporter):
    """One line: combinations run, refused with a reason, left out for want of options."""
    counted = Counter(
        value
        for reports in terminalreporter.stats.values()
        for report in reports
        for key, value in getattr(report, "user_properties", ())
        if key == KEY and getattr(report, "when", "") == "call"
    )
    if counted:
        words = ("run", "accepted by the plan", "refused with a reason", "need options")
        parts = ", ".join(f"{counted[word]} {word}" for word in words if counted[word])
        terminalreporter.write_line(f"matrix: {sum(counted.values())} combinations: {parts}")
