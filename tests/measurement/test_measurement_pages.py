"""The tutorial on measurements: its commands run on the files of its scripts and print what the page quotes."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from sonolube.cli import main
from sonolube.cli.app import COMMANDS as TABLE

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "measurements.md").read_text(encoding="utf-8")
STEPS = re.findall(r"```console\n\$ (sonolube measure [^\n]*)\n```", PAGE)
COMMANDS = {one.name.split()[1]: one.function for one in TABLE if one.name.startswith("measure ")}


def quoted(step: str) -> list[str]:
    """Lines that the page shows before its next command or heading."""
    after = re.split(r"\n## |```console", PAGE.split(step, 1)[1])[0]
    return [line for block in re.findall(r"```text\n(.*?)```", after, flags=re.DOTALL) for line in block.splitlines()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place: Path = tmp_path_factory.mktemp("tutorial")
    (place / "examples").symlink_to(ROOT / "examples")
    for script in re.findall(r"\$ python (examples/\S+) measured", PAGE):
        subprocess.run([sys.executable, script, "measured"], cwd=place, check=True, capture_output=True)
    return place


@pytest.mark.parametrize("step", STEPS)
def test_a_step_of_the_tutorial_prints_what_the_page_quotes(
    step: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", "80")
    words = shlex.split(step)[1:]
    with pytest.raises(SystemExit) as ended:
        main(words)
    answer = capsys.readouterr().out
    assert ended.value.code == (1 if words[2] == "measured" else 0)
    assert [line for line in quoted(step) if line not in answer] == []
    if "--report" in words:
        assert (folder / words[words.index("--report") + 1]).stat().st_size > 10_000


@pytest.mark.parametrize("name", COMMANDS)
def test_every_measurement_has_a_section_with_its_example(name: str) -> None:
    page = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    example = re.search(r"Example: (sonolube measure .*)", COMMANDS[name].__doc__ or "")
    assert example
    assert f"\n## measure {name}\n" in page
    assert example[1].strip() in page
    assert f" measure {name} " in PAGE
