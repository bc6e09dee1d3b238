"""The tables in README and docs are those of the reports' files, and every row holds or says why not."""

from __future__ import annotations

import json

import attrs
import pytest

from benchmarks.claims import FOLDER, Claim
from benchmarks.evidence import Row, _files, below, names, near, show
from benchmarks.evidence.__main__ import main, other_verdicts
from benchmarks.evidence._chosen import CHOSEN, chosen
from benchmarks.night import changes

REPORTS = _files.read()


@pytest.mark.parametrize("document", _files.documents(), ids=lambda path: path.name)
def test_tables_in_documents_are_those_of_the_reports(document):
    text = document.read_text(encoding="utf-8")
    assert _files.render(text, REPORTS, _files.links_from(document)) == text, "run python -m benchmarks.evidence --render"


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_rows_hold_or_say_why_not(name):
    data = REPORTS[name]
    assert data["rows"], "a report without rows shows nothing"
    assert {"title", "rows", "command", "commit", "machine", "date"} <= set(data)
    assert set(data["machine"]) == {"cores", "processor", "system", "python", "numba"}
    for row in data["rows"]:
        if "basis" in row:
            assert bool(row["misses"]) != Claim(**row).holds
            continue
        assert set(row) == {field.name for field in attrs.fields(Row)}
        assert row["ok"] or row["note"], f"{row['quantity']} does not hold and has no note"


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_markdown_is_made_of_the_json(name):
    assert (_files.FOLDER / f"{name}.md").read_text(encoding="utf-8") == _files.page(REPORTS[name])


def test_every_report_has_a_module():
    """A module without a report gets one the next night."""
    claims = [path.stem.removeprefix("test_") for path in FOLDER.rglob("test_*.py")]
    assert not set(claims) & set(names()), "a report is a module of claims or of rows, not both"
    assert set(REPORTS) <= {*claims, *names()}


def test_verdicts_are_compared_and_not_digits():
    before = [attrs.asdict(near(name, 1.001, 1.0, 0.01, "c")) for name in ("a", "b", "gone")]
    now = [near("a", 0.999, 1.0, 0.01, "c"), near("b", 1.02, 1.0, 0.01, "c", "far"), below("new", 1.0, 2.0, "c")]
    assert other_verdicts(before, now) == [
        "no longer there: gone",
        "does not hold, did: b = 1.02, limit 1 within 1 %. far",
        "not in the report: new",
    ]


def test_changes_of_a_night_are_verdicts_and_values_by_more_than_2_percent():
    def report(**values):
        return {"one": {"rows": [attrs.asdict(near(name, value, 1.0, 0.05, "c")) for name, value in values.items()]}}

    lines = changes(report(a=1.0, b=1.0, c=1.0, d=1.0), report(a=1.01, b=1.03, c=1.06, e=1.0))
    assert lines == ["one: no longer there: d", "one: b: 1 -> 1.03", "one: c: 1 -> 1.06, MISSES now", "one: new: e = 1"]


def test_blocks_are_replaced_whole_and_unknown_ones_refused():
    row = near("x [m]", 1.001, 1.0, 0.01, "python")
    reports = {"one": {"title": "One", "rows": [attrs.asdict(row)], "date": "d", "commit": "c"}}
    text = "a\n<!-- evidence:one -->\nstale\n<!-- /evidence -->\nb\n<!-- evidence:summary -->\n<!-- /evidence -->\n"
    new = _files.render(text, reports)
    assert "stale" not in new and "| x [m] | 1.001 | 1 within 1 % | yes |  |" in new and "| 1 of 1 | c, d |" in new
    assert _files.render(new, reports) == new
    with pytest.raises(KeyError, match="two"):
        _files.render(text.replace("evidence:one", "evidence:two"), reports)


def test_rows_judge():
    assert near("k", 1.004, 1.0, 0.005, "c").ok and not near("k", 1.006, 1.0, 0.005, "c").ok
    assert below("e", 1e-10, 1e-9, "c").ok and not below("e", float("nan"), 1e-9, "c").ok


def test_rows_on_the_screen_end_with_a_verdict(capsys):
    rows = {"good": [below("e", 1.0, 2.0, "c")], "bad": [below("e", 3.0, 2.0, "c")]}
    assert [show(asked, ["good", "bad"], rows.__getitem__) for asked in (["good"], [], ["other"])] == [0, 1, 2]
    told = capsys.readouterr()
    assert "NO  bad: e: 3.0 (at most 2)" in told.out and "nothing is called other; there are good, bad" in told.err


def test_rows_without_a_limit_are_counted_apart():
    judged, other = near("x", 1.0, 1.0, 0.01, "c"), Row("y", 2.0, "reported", True, "c")
    count = [_files.holding({"rows": [attrs.asdict(row) for row in rows]}) for rows in ([judged, other], [judged], [other])]
    assert count == ["1 of 1, 1 reported", "1 of 1", "1 reported"]


def test_unknown_report_is_exit_code_2(capsys):
    assert main(["nothing"]) == 2
    assert "no report is called nothing; there are" in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_json_has_no_nan(name):
    def refuse(word: str) -> None:
        raise AssertionError(f"{name}.json holds {word}")

    json.loads((_files.FOLDER / f"{name}.json").read_text(encoding="utf-8"), parse_constant=refuse)


def test_readme_shows_nothing_that_rests_on_ourselves():
    reports = _files.read()
    _, quantity, _ = CHOSEN["readme"][0]
    (row,) = [row for row in reports["published"]["rows"] if row["quantity"] == quantity]
    row["basis"] = "own other method"
    with pytest.raises(KeyError, match="README shows closed form, published, other program"):
        chosen("readme", reports, "")
