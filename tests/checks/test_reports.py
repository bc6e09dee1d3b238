"""The tables in README and docs are those of the reports' files, and every row holds or says why not."""

import json
from types import SimpleNamespace

import pytest

from checks import reports as files
from checks.claims import Claim, claims_into
from checks.night import changes
from checks.reports import CHOSEN, chosen
from checks.robustness import above, below, show

REPORTS = files.read()


@pytest.mark.parametrize("document", files.documents(), ids=lambda path: path.name)
def test_tables_in_documents_are_those_of_the_reports(document):
    text = document.read_text(encoding="utf-8")
    assert files.render(text, REPORTS, files.links_from(document)) == text, "run python -m checks.reports"


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_rows_hold_or_say_why_not(name):
    data = REPORTS[name]
    assert data["rows"], "a report without rows shows nothing"
    assert {"title", "rows", "command", "commit", "machine", "date"} <= set(data)
    assert set(data["machine"]) == {"cores", "processor", "system", "python", "numba"}
    for row in data["rows"]:
        assert bool(row["misses"]) != Claim(**row).holds


def test_the_site_has_a_page_of_each_report_and_links_to_it(tmp_path):
    (tmp_path / "one.json").write_text(
        json.dumps(_report(x=1.001)["one"] | {"command": "pytest", "seconds": 1.0}), encoding="utf-8"
    )
    files.write_pages(tmp_path)
    assert (tmp_path / "one.md").read_text(encoding="utf-8").startswith("# One\n")
    hooks = {}
    files.setup(SimpleNamespace(connect=hooks.__setitem__))
    source = ["see ([report](reports/one.json)) and [data](one.json)"]
    hooks["source-read"](None, "page", source)
    assert set(hooks) == {"builder-inited", "source-read"}
    assert source == ["see ([report](reports/one.md)) and [data](one.json)"]


def test_every_report_has_a_module():
    """A module without a report gets one the next night."""
    folders = (files.ROOT.glob(f"{name}/**/evidence/test_*.py") for name in ("tests", "packages"))
    assert set(REPORTS) <= {path.stem.removeprefix("test_") for found in folders for path in found}


def _report(**values):
    """One of claims near 1 within 5 %."""
    rows: list = []
    claim = claims_into(rows)
    for name, value in values.items():
        claim(name, value, unit="m", near=1.0, within=0.05, basis="published", misses="far" if value > 1.05 else "")
    return {"one": {"title": "One", "rows": [row for _, row in rows], "date": "d", "commit": "c"}}


def test_changes_of_a_night_are_verdicts_and_values_by_more_than_2_percent():
    lines = changes(_report(a=1.0, b=1.0, c=1.0, d=1.0), _report(a=1.01, b=1.03, c=1.06, e=1.0))
    assert lines == ["one: no longer there: d", "one: b: 1 -> 1.03", "one: c: 1 -> 1.06, MISSES now", "one: new: e = 1"]


def test_blocks_are_replaced_whole_and_unknown_ones_refused():
    reports = _report(x=1.001)
    text = "a\n<!-- evidence:one -->\nstale\n<!-- /evidence -->\nb\n<!-- evidence:summary -->\n<!-- /evidence -->\n"
    new = files.render(text, reports)
    assert "stale" not in new and "| x [m] | 1.001, 0.95…1.05 | 1 |" in new and "| 1 of 1 | c |" in new
    assert files.render(new, reports) == new
    with pytest.raises(KeyError, match="two"):
        files.render(text.replace("evidence:one", "evidence:two"), reports)


def test_rows_judge():
    assert above("k", 1.0, 1.0).ok and not above("k", float("nan"), 1.0).ok
    assert below("e", 1e-10, 1e-9).ok and not below("e", float("nan"), 1e-9).ok


def test_rows_on_the_screen_end_with_a_verdict(capsys):
    rows = {"good": [below("e", 1.0, 2.0)], "bad": [below("e", 3.0, 2.0)]}
    assert [show(asked, ["good", "bad"], rows.__getitem__) for asked in (["good"], [], ["other"])] == [0, 1, 2]
    told = capsys.readouterr()
    assert "NO  bad: e: 3.0 (at most 2)" in told.out and "nothing is called other; there are good, bad" in told.err


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_json_has_no_nan(name):
    def refuse(word: str) -> None:
        raise AssertionError(f"{name}.json holds {word}")

    json.loads((files.FOLDER / f"{name}.json").read_text(encoding="utf-8"), parse_constant=refuse)


def test_readme_shows_nothing_that_rests_on_ourselves():
    reports = files.read()
    _, quantity, _ = CHOSEN["readme"][0]
    (row,) = [row for row in reports["published"]["rows"] if row["quantity"] == quantity]
    row["basis"] = "own other method"
    with pytest.raises(KeyError, match="README shows closed form, published, other program"):
        chosen("readme", reports, "")
