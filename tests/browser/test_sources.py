"""Sources of the pages: no markup from text, no other host, modules of others unchanged, and sizes."""

import gzip
import re
from hashlib import sha256
from pathlib import Path

STATIC = Path(__file__).parents[2] / "src" / "sonolube" / "browser" / "static"
SCRIPTS = [*sorted((STATIC / "scripts").rglob("*.js")), STATIC / "link.js"]
FORBIDDEN = (
    *("innerHTML", "outerHTML", "insertAdjacentHTML", "dangerouslySetInnerHTML"),
    *("document.write", "eval(", "new Function"),
)
_IMPORTED = re.compile(r"""^import .*? from '(\.[^']+)';$""", re.MULTILINE)


def test_no_script_makes_markup_from_text() -> None:
    assert [
        (path.name, word) for path in SCRIPTS for word in FORBIDDEN if word in path.read_text(encoding="utf-8")
    ] == []


def test_no_page_names_another_host_or_an_address_from_the_root() -> None:
    for path in [*SCRIPTS, *STATIC.glob("*.html"), *STATIC.glob("*.css")]:
        text = path.read_text(encoding="utf-8")
        assert re.findall(r"https?://(?!www\.w3\.org/)[\w.]+", text) == [], path.name
        assert re.findall(r"""(?:src|href)=["']/""", text) == [], path.name
        assert re.findall(r"""fetch\(["'`]/""", text) == [], path.name


def test_no_page_has_scripts_or_styles_in_its_text() -> None:
    for path in STATIC.glob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert re.findall(r"<script(?![^>]*\bsrc=)|<style|\bon\w+=|\bstyle=", text) == [], path.name


def test_no_line_of_a_script_is_longer_than_120_characters() -> None:
    lines = [
        (path.name, number)
        for path in SCRIPTS
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if len(line) > 120
    ]
    assert lines == []


def test_modules_of_others_are_those_that_are_listed() -> None:
    table = (STATIC / "vendor" / "README.md").read_text(encoding="utf-8")
    modules = [path for path in STATIC.glob("vendor/*") if path.suffix in (".js", ".css")]
    found = {path.name: sha256(path.read_bytes()).hexdigest() for path in modules}
    assert found == dict(re.findall(r"\| `([^`]+)` \|.*`([0-9a-f]{64})` \|", table))
    licences = {path.name for path in STATIC.glob("vendor/*-LICENSE.txt")}
    assert licences == {f"{name}-LICENSE.txt" for name in ("htm", "preact", "uplot")}


def first_files() -> set[Path]:
    """Files that the first page names: styles, scripts and its icon."""
    text = (STATIC / "index.html").read_text(encoding="utf-8")
    return {STATIC / name for name in re.findall(r'(?:href|src)="static/([^"]+)"', text)}


def test_the_first_page_names_each_module_that_its_modules_import() -> None:
    named = {path for path in first_files() if path.suffix == ".js"}
    imported = {
        (path.parent / name).resolve() for path in named for name in _IMPORTED.findall(path.read_text(encoding="utf-8"))
    }
    assert imported <= named


def test_the_first_page_transfers_at_most_150_kilobytes() -> None:
    files = [STATIC / "index.html", *first_files()]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) <= 150_000
