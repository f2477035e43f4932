"""Files of measurements by their paths, folders and patterns."""

import re
from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput

_PATTERN: Final = re.compile(r"[*?[]")  # of a shell, where it did not replace the pattern itself


def selected_files(given: Iterable[Path]) -> list[Path]:
    """Files, folders and patterns replaced by their files in the order of their names, numbers by their size."""
    files: list[Path] = []
    for path in given:
        is_pattern = _PATTERN.search(path.name) and path.parent.is_dir() and not path.exists()
        matches = [each for each in path.parent.iterdir() if fnmatch(each.name, path.name)] if is_pattern else []
        if matches:
            files += sorted(matches, key=_by_numbers)
            continue
        if not path.is_dir():
            files.append(path)
            continue
        inside = [each for each in path.iterdir() if each.is_file() and not each.name.startswith(".")]
        if path / "documents.jsonl" in inside:  # the folder of a run of the laboratory
            inside = [each for each in inside if each.suffix == ".nc" and not each.name.startswith("clock-")]
        inside.sort(key=_by_numbers)
        if not inside:
            raise InvalidInput(f"{path}: holds no file")
        files += inside
    return files


def _by_numbers(path: Path) -> list[tuple[int, str]]:
    """Sort key of a name by which part-2 comes before part-10."""
    return [(int(piece), "") if piece.isdecimal() else (-1, piece) for piece in re.split(r"(\d{1,18})", path.name)]
