"""Hostile text in keys, values, titles and the name of a rig file."""

import json
import random
import re
import tempfile
from pathlib import Path

from reliability.hostile_text import COLLAR, HOSTILE, TRIBOMETER, outcome_measures, program_record
from reliability.study import Record, Study

_COMMANDS = (
    ("friction",),
    ("contact",),
    ("simulate",),
    ("friction", "--json"),
    ("sweep", "--of", "load", "--points", "2"),
)
_NAMES = (b"rig.toml", b"\xff\xfe.toml", b"$x_{$.toml", b"<b>.toml", b"\x1b[31m.toml", "\u202egir.toml".encode())
_STRING = re.compile(r'"[^"\n]*"')
_KEY = re.compile(r"^(\w+) =", re.MULTILINE)


def _quoted(text: str) -> str:
    """Text as a string of TOML; bytes that are no UTF-8 stay as they are."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _mutated(text: str, rng: random.Random) -> str:
    """Rig file with some hostile text in one place."""
    hostile = rng.choice(HOSTILE)
    kind = rng.randrange(6)
    if kind == 0:
        return re.sub(r"^title = .*$", lambda _: f"title = {_quoted(hostile)}", text, count=1, flags=re.MULTILINE)
    if kind == 1:
        place = rng.choice(list(_STRING.finditer(text)))
        return text[: place.start()] + _quoted(hostile) + text[place.end() :]
    if kind == 2:
        place = rng.choice(list(_KEY.finditer(text)))
        return text[: place.start(1)] + _quoted(hostile) + text[place.end(1) :]
    if kind == 3:
        return f"{_quoted(hostile)} = 1\n{text}"
    if kind == 4:
        return f"{hostile}\n{text}"
    place = rng.choice(list(_STRING.finditer(text)))
    return text[: place.start()] + (hostile or "9" * 5000) + text[place.end() :]


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    text = _mutated(Path(rng.choice((TRIBOMETER, COLLAR))).read_text(encoding="utf-8"), rng)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / rng.choice(_NAMES).decode(errors="surrogateescape")
        path.write_bytes(text.encode(errors="surrogatepass"))
        command, *options = rng.choice(_COMMANDS)
        return program_record([command, str(path), *options])


STUDY = Study(
    title="Hostile text in a rig file",
    question="A rig file with formulas, markup, control characters, endless numbers or deep tables in a key, a value, "
    "its title or its name is answered or refused in one line, within 5 s.",
    sources=("rig/file/*.py", "text/toml_text.py", "text/plain_text.py", "figure.py", "cli/app.py", "cli/console/*.py"),
    trials=1000,
    sample=8,
    trial=_trial,
    measures=outcome_measures,
)
