"""The demonstration of a fresh clone: its environment has finite elements, in the versions of the tests."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def pinned(name: str) -> dict[str, str]:
    text = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8")
    return dict(re.findall(r"^([\w.-]+)==([^\s;]+)", text, re.MULTILINE))


def test_the_environment_of_the_demonstration_is_the_core_with_finite_elements() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    parts = {re.split(r"[<>=]", each)[0] for each in project["optional-dependencies"]["fem"]}
    core, demo, tests = map(pinned, ("runtime", "demo", "test"))
    assert parts <= demo.keys()
    assert not parts & core.keys()
    assert core.items() <= demo.items() <= tests.items()


def test_the_demonstration_uses_that_environment_and_ends_with_the_reproduction() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    target = makefile[makefile.index("\ndemo:") :].partition("\n\n")[0]
    assert target.splitlines()[1].startswith("demo: $(VENV)/demo ")
    assert "sonolube reproduce" in target.splitlines()[-1]
    assert "$(VENV)/demo: $(VENV)/runtime requirements/demo.txt\n" in makefile
