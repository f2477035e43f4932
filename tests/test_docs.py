"""The documentation against the product: nothing missing, nothing stale, no dead ends."""

import importlib
import inspect
import json
import pkgutil
import re
import shlex
import shutil
from pathlib import Path

import pytest
from sentences import first_prediction

import sonolube
from sonolube import models
from sonolube.cli import main
from sonolube.cli.app import COMMANDS as TABLE
from sonolube.facts.materials import material_names
from sonolube.rig import rig_schema

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
COMMANDS = {command.name: command.function for command in TABLE}


def text_of(*pages: Path) -> str:
    return "\n".join(page.read_text(encoding="utf-8") for page in pages)


def help_example(name: str) -> str:
    found = re.search(r"Example: (sonolube .*)", COMMANDS[name].__doc__ or "")
    assert found, f"{name} has no example"
    return found[1].strip()


SERVERS = ("sonolube app",)  # which run until they are ended


def calls() -> list[tuple[str, bool]]:
    """Commands on rigs that the pages show, and whether each is shown to be refused."""
    text = text_of(*PAGES)
    answered = re.findall(r"^```\{answer\} (sonolube .*)\n(:refused:)?", text, flags=re.MULTILINE)
    typed = re.findall(r"^\$ (sonolube .*)$", text, flags=re.MULTILINE)
    shown = {(call, bool(refused)) for call, refused in answered} | {(call, False) for call in typed}
    rigs = ("examples/rigs/", "my-rig.toml")
    return sorted(each for each in shown if any(rig in each[0] for rig in rigs) and not each[0].startswith(SERVERS))


def documented_modules() -> set[str]:
    return set(re.findall(r"^\.\. automodule:: (\S+)$", text_of(*DOCS.glob("reference/*.md")), flags=re.MULTILINE))


def anchors_of(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", text_of(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


def test_every_material_that_an_example_names_is_in_the_catalogue() -> None:
    named = re.findall(r"^(?:pin|disc)_material = \"(\w+)\"", text_of(*PAGES), flags=re.MULTILINE)
    assert named
    assert set(named) <= {*material_names()}


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_a_section_with_its_example(name: str) -> None:
    page = text_of(DOCS / "commands.md")
    assert f"\n## {name}\n" in page
    assert help_example(name) in page


def test_no_section_describes_a_command_that_is_gone() -> None:
    called = re.findall(r"^(?:```\{answer\}|\$) sonolube (\w\S*)", text_of(*PAGES), flags=re.MULTILINE)
    assert set(called) <= {name.split()[0] for name in COMMANDS}


@pytest.mark.parametrize(("call", "refused"), calls())
def test_a_command_of_the_pages_runs_as_it_stands(
    call: str, refused: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    shutil.copy(DOCS / "my-rig.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(shlex.split(call)[1:])
    assert (ended.value.code or 0) == (2 if refused else 0), capfd.readouterr().err


def test_the_commands_of_the_walk_run_one_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    walk = re.findall(r"^```\{answer\} (sonolube .*)$", text_of(DOCS / "using-folder.md"), flags=re.MULTILINE)
    assert len(walk) > 6
    for call in walk:
        with pytest.raises(SystemExit) as ended:
            main(shlex.split(call)[1:])
        assert (ended.value.code or 0) == 0, capfd.readouterr().err


def test_every_room_and_module_at_the_top_has_its_reference() -> None:
    top = {f"sonolube.{module.name}" for module in pkgutil.iter_modules(sonolube.__path__)}
    top -= {"sonolube.cli", "sonolube.__main__"}
    assert top <= documented_modules()


def test_every_room_of_the_models_has_its_reference() -> None:
    rooms = {f"sonolube.models.{module.name}" for module in pkgutil.iter_modules(models.__path__)}
    assert len(rooms) > 6
    assert rooms <= documented_modules()


def test_public_names_that_automodule_passes_over_are_written_out() -> None:
    page = text_of(*DOCS.glob("reference/*.md"))
    for module_name in documented_modules():
        module = importlib.import_module(module_name)
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            if not (inspect.isclass(value) or callable(value) or inspect.ismodule(value)):
                assert f".. py:data:: {name}\n   :module: {module_name}\n" in page


def test_every_page_of_the_reference_is_in_its_contents() -> None:
    listed = set(text_of(DOCS / "reference" / "index.md").split())
    assert {page.stem for page in DOCS.glob("reference/*.md")} - {"index"} <= listed


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_every_local_link_leads_somewhere(page: Path) -> None:
    text = text_of(page)
    for target in re.findall(r"\{doc\}`(?:[^`<]*<)?([^`>]+)>?`", text):
        assert (page.parent / f"{target}.md").is_file(), target
    for target in re.findall(r"\{download\}`(?:[^`<]*<)?([^`>]+)>?`|\{literalinclude\} (\S+)", text):
        assert (page.parent / "".join(target)).is_file(), target
    for target, anchor in re.findall(r"\]\((?!https?://)([^)#\s]*)#?([^)\s]*)\)", text):
        linked = page.parent / target if target else page
        assert linked.is_file(), target
        assert not anchor or anchor in anchors_of(linked), anchor


def test_the_schema_in_the_docs_is_that_of_the_product() -> None:
    assert json.loads(text_of(DOCS / "rig.schema.json")) == rig_schema(), "run: sonolube schema > docs/rig.schema.json"


@pytest.mark.parametrize("rig", sorted((ROOT / "examples" / "rigs").glob("*.toml")), ids=lambda path: path.stem)
def test_the_first_line_of_an_example_rig_points_at_the_schema(rig: Path) -> None:
    directive, _, target = rig.read_text(encoding="utf-8").splitlines()[0].partition(" ")
    assert directive == "#:schema"
    assert (rig.parent / target).resolve() == DOCS / "rig.schema.json"


def test_every_verdict_is_explained() -> None:
    from dong2015 import Verdict

    page = text_of(DOCS / "validation.md")
    assert all(f"\n`{verdict.value}`\n: " in page for verdict in Verdict)


def test_the_theory_lists_every_choice_of_a_rig_file_from_its_record() -> None:
    from sonolube.models.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS
    from sonolube.models.friction import FRICTION_MODELS

    contact, friction = (text_of(DOCS / "theory" / page) for page in ("contact.md", "friction.md"))
    assert "\n<!-- table: asperity_laws -->\n" in contact
    assert "\n<!-- table: height_distributions -->\n" in contact
    assert "\n<!-- table: friction_models -->\n" in friction
    assert all(law.__doc__ and law.citation for law in ASPERITY_LAWS.values())
    assert all(heights.__doc__ and heights.citation for heights in HEIGHT_DISTRIBUTIONS.values())
    assert all(model.__doc__ and model.citation for model in FRICTION_MODELS.values())


def test_pages_load_nothing_from_elsewhere() -> None:
    settings = text_of(*DOCS.glob("**/*.py"), *PAGES)
    assert '"sphinx-mathjax-offline"' in settings
    assert not re.findall(
        r"(?:src|import|url)\s*[=(]\s*[\"']?https?://|\{image\} https?://|!\[[^\]]*\]\(https?://", settings
    )


def test_the_first_example_of_the_first_page_says_what_the_commands_beside_it_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (new,) = re.findall(r"^    sonolube (new my-rig.toml .*)$", text_of(ROOT / "README.md"), flags=re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    for words in (shlex.split(new), ["predict", "my-rig.toml"]):
        with pytest.raises(SystemExit, match=r"^0$"):
            main(words)
    assert first_prediction().strip("*") in " ".join(capsys.readouterr().out.split())


def test_no_page_types_what_a_prediction_says_of_friction() -> None:
    typed = re.compile(
        r"friction (?:falls|rises) by (?:about )?\W*\d+(?: to \d+)? %\. Likely|likely between \d", re.IGNORECASE
    )
    assert [page.name for page in (*PAGES, ROOT / "README.md") if typed.search(page.read_text(encoding="utf-8"))] == []


def test_the_quick_tests_are_there() -> None:
    places = (ROOT / "tests" / "quick.txt").read_text(encoding="utf-8").split()
    assert [place for place in places if not (ROOT / place).exists()] == []
