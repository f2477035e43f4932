"""The reproduction report: whole, self-contained, and the same in every form."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from tests.reproduced import reproduced

from dong2015 import Verdict, reproduction, summary_lines, validation_object, write_report
from sonolube.errors import InvalidInput, UnknownName
from sonolube.storage.files import write_atomically

KEYS = (
    "id",
    "kind",
    "chapter",
    "source",
    "quantity",
    "unit",
    "printed",
    "published",
    "published_low",
    "published_high",
    "computed",
    "computed_low",
    "computed_high",
    "possible_low",
    "possible_high",
    "relative_error",
    "verdict",
    "note",
    "errata",
    "alternatives",
)


class Collector(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("src", "href") and value:
                self.addresses.append(value)
            if name == "id" and value:
                self.ids.append(value)


def test_the_page_needs_nothing_but_itself(chapter_3_report: Path) -> None:
    page = Collector()
    text = (chapter_3_report / "reproduction.html").read_text(encoding="utf-8")
    page.feed(text)
    assert page.addresses
    assert all(address.startswith(("data:", "#")) for address in page.addresses)
    assert not re.search(r"url\(|@import|https?://", text)
    assert len(page.ids) == len(set(page.ids))


def test_every_row_stands_in_page_and_json_alike(chapter_3_report: Path) -> None:
    rows = json.loads((chapter_3_report / "validation.json").read_text(encoding="utf-8"))["rows"]
    page = Collector()
    page.feed((chapter_3_report / "reproduction.html").read_text(encoding="utf-8"))
    assert [row["id"] for row in rows] == [name for name in page.ids if name in {row["id"] for row in rows}]
    assert all(tuple(row) == KEYS for row in rows)
    assert {row["verdict"] for row in rows} <= {verdict.value for verdict in Verdict}


def test_every_figure_comes_as_png_and_svg(chapter_3_report: Path) -> None:
    names = {figure.name for figure in reproduced(3).figures}
    assert {path.stem for path in (chapter_3_report / "figures").glob("*.png")} == names
    assert {path.stem for path in (chapter_3_report / "figures").glob("*.svg")} == names


def test_the_whole_dissertation_gives_what_was_promised() -> None:
    result = reproduced()
    identifiers = [row.id for row in result.rows]
    assert len(result.rows) >= 150
    assert len(identifiers) == len(set(identifiers))
    assert {row.chapter for row in result.rows} == {2, 3, 4, 5}
    assert all(row.note for row in result.rows)
    for row in result.rows:
        within = row.computed is not None and (
            row.published_low - 1e-9 * abs(row.published_low)
            <= row.computed
            <= row.published_high + 1e-9 * abs(row.published_high)
        )
        if row.verdict is not Verdict.UNDETERMINED:
            assert within == (row.verdict in (Verdict.REPRODUCED, Verdict.FITTED, Verdict.TRIVIALLY_MET)), row


@pytest.mark.parametrize(
    ("pattern", "count"),
    [(r"table-4\.1-actuator-power-\d+", 6), (r"2\.2\.5-power-\d", 3), (r"table-2\.5-vibration-contact-count-\d", 3)],
)
def test_powers_and_contacts_are_all_reproduced(pattern: str, count: int) -> None:
    verdicts = [row.verdict for row in reproduced().rows if re.fullmatch(pattern, row.id)]
    assert len(verdicts) >= count - 1  # zero volts draw no power and need no row
    assert set(verdicts) == {Verdict.REPRODUCED}


def test_the_summary_counts_what_the_json_counts() -> None:
    result = reproduced(3)
    text = "\n".join(summary_lines(result))
    for verdict, count in validation_object(result)["verdicts"].items():
        assert bool(count) == bool(re.search(rf"{verdict.replace('_', ' ')}\s.*\b{count}$", text, re.MULTILINE))


def test_the_summary_is_a_scorecard_within_eighty_columns_and_no_list_of_rows() -> None:
    result = reproduced()
    lines = summary_lines(result)
    assert max(map(len, lines)) <= 80
    assert len(lines) < 50
    text = " ".join("\n".join(lines).split())
    assert all(f" {number} " in f" {text}" for number in range(1, 11))
    assert not [row.id for row in result.rows if row.id in text]


def test_the_page_begins_with_the_claims_and_links_each_to_its_rows(chapter_3_report: Path) -> None:
    page = Collector()
    text = (chapter_3_report / "reproduction.html").read_text(encoding="utf-8")
    page.feed(text)
    assert text.index('id="claims"') < text.index('id="counts"') < text.index('id="chapter-3"')
    links = [address[1:] for address in page.addresses if address.startswith("#")]
    assert {"3.2.2-error", "3.3.4-error"} <= set(links) <= set(page.ids)


def test_the_claims_stand_in_the_json_with_their_evidence(chapter_3_report: Path) -> None:
    found = json.loads((chapter_3_report / "validation.json").read_text(encoding="utf-8"))
    ids = {row["id"] for row in found["rows"]}
    assert [claim["id"] for claim in found["claims"]] == [
        "cube-friction",
        "cube-wear",
        "multi-scale-friction",
        "trends",
    ]
    assert all(ids >= set(claim["decisive_rows"]) for claim in found["claims"])


def test_a_chapter_without_numbers_is_refused() -> None:
    with pytest.raises(UnknownName, match="unknown chapter '5'"):
        reproduction(chapter=5)


def test_a_folder_that_cannot_be_made_is_refused_and_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file")
    result = reproduced(3)
    with pytest.raises(InvalidInput, match="cannot be written"):
        write_report(replace(result, figures=result.figures[:1]), folder=tmp_path / "taken")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_a_failed_write_leaves_the_old_file_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_atomically(tmp_path / "kept.txt", "old")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(InvalidInput, match="No space left on device"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["kept.txt"]
