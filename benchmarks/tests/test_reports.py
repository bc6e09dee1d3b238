"""The tables in README and docs are those of the reports' files, and every row holds or says why not."""

from __future__ import annotations

import json

import attrs
import pytest

from benchmarks.evidence import Row, _age, _files, below, names, near
from benchmarks.evidence.__main__ import main, other_verdicts
from benchmarks.evidence._areas import AREAS, MEASURES

REPORTS = _files.read()


@pytest.mark.parametrize("document", _files.documents(), ids=lambda path: path.name)
def test_tables_in_documents_are_those_of_the_reports(document):
    text = document.read_text(encoding="utf-8")
    assert _files.render(text, REPORTS, _age.listed(), _files.links_from(document)) == text, (
        "run python -m benchmarks.evidence --render"
    )


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_rows_hold_or_say_why_not(name):
    data = REPORTS[name]
    assert data["rows"], "a report without rows shows nothing"
    assert {"title", "rows", "command", "commit", "machine", "date", "digest"} <= set(data)
    assert set(data["machine"]) == {"cores", "processor", "system", "python", "numba"}
    for row in data["rows"]:
        assert set(row) == {field.name for field in attrs.fields(Row)}
        assert row["ok"] or row["note"], f"{row['quantity']} does not hold and has no note"


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_markdown_is_made_of_the_json(name):
    assert (_files.FOLDER / f"{name}.md").read_text(encoding="utf-8") == _files.page(REPORTS[name])


def test_every_report_has_been_run_and_every_file_has_a_module():
    assert sorted(REPORTS) == names()


def test_reports_older_than_their_code_are_those_on_the_list():
    outdated, listed = set(_age.out_of_date(REPORTS)), set(_age.listed())
    assert not outdated - listed, "make them again, or list them: python -m benchmarks.evidence --help"
    assert not listed - outdated, "up to date: take them off docs/reports/older.toml"


def test_every_file_of_the_package_has_an_area_and_every_report_measures_some():
    assert not [path for path in _age.package_files() if _age.area(path) is None], "give it its place in _areas.AREAS"
    places = [place for places in AREAS.values() for place in places.split()]
    assert sorted(set(places)) == sorted(places)
    stems = {place for path in _age.package_files() for place in (path.with_suffix(""), *path.parents)}
    assert not [place for place in places if _age.PACKAGE / place not in stems], "a place that is not there"
    words = {word for words in MEASURES.values() for word in words.split()}
    assert sorted(MEASURES) == names() and {word for word in words if "/" not in word} == set(AREAS) - {"no report"}
    assert all((_age.ROOT / word).exists() for word in words if "/" in word)


@pytest.mark.parametrize(
    ("changed", "aged", "spared"),
    [
        ("core/elastic/cage.py", {"elastic", "stability"}, {"sweep", "tangent", "condensed_patches"}),
        ("studies/sweep/__init__.py", {"sweep", "dask"}, {"elastic", "tangent"}),
        ("core/ring/equilibrium.py", {"tangent", "expected_values"}, {"sweep", "hexahedron"}),
        ("studies/sweep/command.py", set(), set(MEASURES)),
    ],
)
def test_a_change_ages_the_reports_that_measure_it_and_no_others(changed, aged, spared):
    measuring = {name for name in MEASURES if _age.PACKAGE / changed in _age.measured(name)}
    assert aged <= measuring and not spared & measuring


def test_what_a_report_imports_beside_the_package_is_measured_and_the_runner_is_not():
    files = {path.relative_to(_age.ROOT).as_posix() for path in _age.measured("equilibria")}
    assert {"benchmarks/evidence/equilibria.py", "validation/scenes.py"} <= files
    assert "benchmarks/evidence/_files.py" not in files


def test_words_and_places_of_code_age_nothing_and_code_does(tmp_path):
    def pieces(number: int, text: str) -> tuple[str, ...]:
        (tmp_path / f"{number}.py").write_text(text, encoding="utf-8")
        return _age._pieces(tmp_path / f"{number}.py")

    code = 'def f(x):\n    """Twice."""\n    return 2 * x  # "as is"\n\n\nLIMIT = 3\n'
    reworded = (
        'from a.b import c\n\n\ndef f(x):\n    """Two times\n\n    x.\n    """\n\n    # more\n    import d\n'
        "\n    return (\n        2 * x\n    )\n\n\nLIMIT = 3\n"
    )
    assert pieces(1, code) == pieces(2, reworded) == ("def f(x):\n    return 2 * x", "LIMIT = 3")
    assert len({pieces(3 + i, code.replace("2 * x", text)) for i, text in enumerate(("3 * x", "2 * x", '"# x"'))}) == 3
    # What is carried from one file of an area into another one counts as before.
    assert sorted(pieces(6, "LIMIT = 3\n") + pieces(7, code.split("LIMIT")[0])) == sorted(pieces(8, code))


def test_verdicts_are_compared_and_not_digits():
    before = [attrs.asdict(near(name, 1.001, 1.0, 0.01, "c")) for name in ("a", "b", "gone")]
    now = [near("a", 0.999, 1.0, 0.01, "c"), near("b", 1.02, 1.0, 0.01, "c", "far"), below("new", 1.0, 2.0, "c")]
    assert other_verdicts(before, now) == [
        "no longer there: gone",
        "does not hold, did: b = 1.02, limit 1 within 1 %. far",
        "not in the report: new",
    ]


def test_older_reports_are_told_with_their_reason_and_a_wrong_list_is_exit_code_1(capsys, monkeypatch):
    name, other = sorted(REPORTS)[:2]
    monkeypatch.setattr(_age, "out_of_date", lambda reports: [name])
    monkeypatch.setattr(_age, "listed", lambda: {name: "2026-01-02: long"})
    assert main(["--older"]) == 0 and f"{name}: 2026-01-02: long" in capsys.readouterr().out
    monkeypatch.setattr(_age, "listed", lambda: {other: "2026-01-02: long"})
    assert main(["--older"]) == 1
    out = capsys.readouterr().out
    assert f"{name}: NOT LISTED" in out and f"{other}: LISTED, BUT UP TO DATE" in out


def test_the_list_of_older_reports_is_kept_sorted_and_reports_leave_it(tmp_path, monkeypatch):
    monkeypatch.setattr(_age, "LISTED", tmp_path / "older.toml")
    _age.LISTED.write_text("", encoding="utf-8")
    _age.put_on_list(["two", "one"], 'the "core" changes')
    assert list(_age.listed()) == ["one", "two"] and _age.listed()["one"].endswith(': the "core" changes')
    _age.take_off_list(["one"])
    assert list(_age.listed()) == ["two"]


def test_blocks_are_replaced_whole_and_unknown_ones_refused():
    row = near("x [m]", 1.001, 1.0, 0.01, "python")
    reports = {"one": {"title": "One", "rows": [attrs.asdict(row)], "date": "d", "commit": "c"}}
    text = "a\n<!-- evidence:one -->\nstale\n<!-- /evidence -->\nb\n<!-- evidence:summary -->\n<!-- /evidence -->\n"
    new = _files.render(text, reports, {"one"})
    assert (
        "stale" not in new
        and "| x [m] | 1.001 | 1 within 1 % | yes |  |" in new
        and "| 1 of 1 | d | c, older than the code |" in new
    )
    assert _files.render(new, reports, {"one"}) == new and "older" not in _files.render(new, reports)
    with pytest.raises(KeyError, match="two"):
        _files.render(text.replace("evidence:one", "evidence:two"), reports)


def test_rows_judge():
    assert near("k", 1.004, 1.0, 0.005, "c").ok and not near("k", 1.006, 1.0, 0.005, "c").ok
    assert below("e", 1e-10, 1e-9, "c").ok and not below("e", float("nan"), 1e-9, "c").ok


def test_rows_without_a_limit_are_counted_apart():
    judged, other = near("x", 1.0, 1.0, 0.01, "c"), Row("y", 2.0, "reported", True, "c")
    count = [_files.holding({"rows": [attrs.asdict(row) for row in rows]}) for rows in ([judged, other], [judged], [other])]
    assert count == ["1 of 1, 1 reported", "1 of 1", "1 reported"]


def test_unknown_report_is_exit_code_2(capsys):
    assert main(["expected_valeus"]) == 2
    assert "expected_values" in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(REPORTS))
def test_json_has_no_nan(name):
    def refuse(word: str) -> None:
        raise AssertionError(f"{name}.json holds {word}")

    json.loads((_files.FOLDER / f"{name}.json").read_text(encoding="utf-8"), parse_constant=refuse)
