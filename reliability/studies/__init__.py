"""The studies, one file each, which defines `STUDY`; a file here is a study by its name."""

from importlib import import_module
from pathlib import Path

from reliability.study import Study

NAMES = tuple(sorted(path.stem for path in Path(__file__).parent.glob("[a-z]*.py")))


def study(name: str) -> Study:
    """Study of a name."""
    found: Study = import_module(f"reliability.studies.{name}").STUDY
    return found
