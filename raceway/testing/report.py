"""The conformance suite of reports."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.testing.scenes import example_result
from raceway.testing.suite import Suite, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Report


class ReportSuite(Suite):
    """Duties of ``raceway.framework.contracts.Report``."""

    kind = "report"

    @duty("write(result, folder) writes files into the folder and returns their paths; a second time too")
    def test_writes(self, report: Report) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(2):
                paths = [Path(p) for p in report.write(example_result(), Path(folder))]
                require(paths, "write() returns no path")
                for path in paths:
                    require(path.is_file() and path.stat().st_size > 0, f"`{path.name}` does not exist or is empty")
                    require(path.resolve().is_relative_to(Path(folder).resolve()), f"`{path}` lies outside the folder")
            written = {p.resolve() for p in Path(folder).rglob("*") if p.is_file()}
            extra = sorted(p.name for p in written - {p.resolve() for p in paths})
            require(not extra, f"{', '.join(extra)} is written but not returned")

    @duty("the result is left untouched")
    def test_result_untouched(self, report: Report) -> None:
        before = example_result().to_dict()
        with tempfile.TemporaryDirectory() as folder:
            report.write(example_result(), Path(folder))
        require(example_result().to_dict() == before, "the result was changed")
