"""The HTML page that studies end in: one file, escaped, nothing fetched, no script."""

import re
from html.parser import HTMLParser

import pytest
from matplotlib.figure import Figure

from raceway.extend import Cell, Page, data_uri, save_figure

PNG = b"\x89PNG\r\n\x1a\n" + b"0" * 8


class _Balanced(HTMLParser):
    """Fails on tags that are not closed in order; keeps the attributes of every tag."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        if tag not in ("meta", "link", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def _page() -> Page:
    page = Page('K & C <of> "B7206C"', "subtitle", "made by `raceway`")
    page.section("First <part>")
    page.text("k < 5 & `load.axial`", kind="lead")
    page.table(["speed", "k", "verdict"], [[12000, "1.5", Cell("holds", "good")], [13000, None, "<b>"]], caption="A table")
    page.section("Second")
    page.listing(["one", "two"])
    page.figures([(PNG, 'a "curve" that rises', "the caption")], wide=True)
    return page


def test_the_page_is_whole_escaped_and_asks_for_nothing(tmp_path):
    text = _page().write(tmp_path / "page.html").read_text(encoding="utf-8")
    seen = _Balanced(text).seen
    tags = [tag for tag, _ in seen]
    assert "script" not in tags and "b" not in tags
    assert not re.search(r"https?://|url\(|@import", text)
    for tag, given in seen:
        if tag in ("img", "link"):
            assert (given.get("src") or given.get("href") or "").startswith("data:")
        if tag == "img":
            assert given["alt"] == 'a "curve" that rises'
    ids = {given["id"] for _, given in seen if given.get("id")}
    links = {given["href"][1:] for tag, given in seen if tag == "a"}
    assert links == ids == {"s1", "s2"}
    assert "<title>K &amp; C &lt;of&gt;" in text and "<code>load.axial</code>" in text


def test_columns_of_numbers_stand_right_and_wide_tables_scroll_in_their_box():
    text = _page().html()
    assert '<td class="number">1.5</td>' in text and '<span class="tone good">holds</span>' in text
    assert re.search(r'<div class="scroll" tabindex="0" role="region" aria-label="A table"><table>', text)
    for words, count in ((["1.5", "failed"], 2), (["1.5", "failed", "lost"], 0)):  # half of them numbers, or less
        page = Page("title")
        page.table(["case", "K"], [["a", word] for word in words])
        assert page.html().count('<td class="number">') == count


def test_an_unknown_tone_is_refused():
    with pytest.raises(ValueError, match="tone"):
        Cell("holds", "splendid")


def test_a_figure_becomes_the_same_bytes_twice(tmp_path):
    figure = Figure(figsize=(2, 1))
    figure.add_subplot().plot([0, 1], [0, 1], label="k")
    first, again = (save_figure(figure, tmp_path / f"{name}.svg").read_bytes() for name in ("first", "again"))
    assert first == again and data_uri(first).startswith("data:image/svg+xml;base64,")
    assert data_uri(PNG).startswith("data:image/png;base64,")
