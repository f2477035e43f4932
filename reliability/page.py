"""docs/reliability.md, written from the measures of full runs in docs/reliability/."""

import json
from pathlib import Path

from reliability.studies import NAMES, study

DATA = Path(__file__).parents[1] / "docs" / "reliability"
PAGE = DATA.with_suffix(".md")

_HEAD = """# Reliability

What was done to the program to make it fail, how often, and what was lost. Every trial has a seed. `make reliability`
repeats all of them on two cores, continues where it was stopped, and writes this page; `make test-all` runs the first
trials of each study. One study alone: `python -m reliability NAME`.

"""


def page() -> str:
    """Text of the page: a section a study, with its measures beside their bars."""
    return _HEAD + "\n".join(_section(name) for name in NAMES)


def _section(name: str) -> str:
    chosen = study(name)
    lines = [f"## {chosen.title}", "", chosen.question, ""]
    if not (path := DATA / f"{name}.json").exists():
        return "\n".join([*lines, f"Not run in full yet: `python -m reliability {name}`.", ""])
    data = json.loads(path.read_text(encoding="utf-8"))
    lines += [
        f"{data['trials']:,} trials: `python -m reliability {name}`.",
        "",
        "| measure | found | bar |  |",
        "|---|---|---|---|",
    ]
    for row in data["measures"]:
        verdict = ("met" if row["holds"] else "**missed**") if row["bar"] else ""
        lines.append(f"| {row['label']} | {row['value']} | {row['bar']} | {verdict} |")
    return "\n".join([*lines, ""])


def write_page() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")
