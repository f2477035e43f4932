"""Damaged files of every kind that tasks take, through whole tasks of Python and whole commands."""

import random
import re
import signal
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Any, NoReturn

from reliability.damage import mutated
from reliability.hostile_text import ROOT, TRIBOMETER, outcome_measures, program_record
from reliability.study import Record, Study
from sonolube.errors import SonolubeError, UnexpectedFault
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.table import task_named
from sonolube.tasks.task import marks_of

_EXAMPLES = ROOT / "examples"
_PLAIN = "plain.csv"  # recording that lies beside the damaged file
_MAPPING = """[channels.friction_force]
column = "friction_force (N)"
unit = "N"

[axis]
column = "time (s)"
unit = "s"
"""
_RUNS_MAPPING = """[channels.friction_force]
column = "friction_force [N]"
unit = "N"
"""
_LONGEST = 60  # s, after which a call counts as one that hangs
_MAX_STEPS = 0.03  # share of STEP files, which the geometry kernel reads slowly
_VALUES = (
    '["x"]', "{a = 1}", "-1e308", "1e308", "1e-320", "nan", "-inf", "true", '""', "[]", "[[1]]", "[1, 2, 3]",
    '"a\\nb"', '"nan N"', '"-1e308 m"', '"1e308 N"', '"0 N"', '"-3 N"', '"x"', "0", "-1", "9" * 400, "1979-05-27",
    '["3 N", "4 N"]', '"3 N"', "null", "{}", '{"a": 1}',
)  # fmt: skip
_CELLS = ("", "nan", "-inf", "1e308", "-1e308", "1e-320", "0", "-1", "x", '"', "1,5", "1.000", "9" * 400, "=1+1", "\0")
_ONLY_PATHS = ("device_map", "record")  # kinds that are not taken as bytes by every task
_TEXTS = (".toml", ".json", ".csv")


@dataclass(frozen=True, slots=True)
class _Door:
    """Call of a task with a file: its name as of a command, the argument of the file, and the other arguments."""

    task: str
    argument: str
    others: Mapping[str, Any]
    is_list: bool = False

    def call(self, file: Any, folder: Path) -> None:
        """Call the task, and render its answer as the terminal and the browser do."""
        others = {name: str(folder / _PLAIN) if value == _PLAIN else value for name, value in self.others.items()}
        answer: Any = task_named(self.task).function(**{self.argument: [file] if self.is_list else file}, **others)
        answer.text()
        answer.to_json()
        answer.dataset()

    def command(self, path: Path, folder: Path) -> list[str]:
        """Words of the command."""
        function = task_named(self.task).function
        marks, by_place, words = marks_of(function), positional(function), self.task.split()
        for name, value in {self.argument: str(path), **self.others}.items():
            flag = getattr(marks[name], "option", "") or f"--{name.replace('_', '-')}"
            words += [*([] if name in by_place else [flag]), *([] if value is True else [str(value)])]
        return [str(folder / _PLAIN) if word == _PLAIN else word for word in words]


def positional(function: Callable[..., Any]) -> list[str]:
    """Names of the arguments of a task that a command takes by their place."""
    arguments = signature(function).parameters.items()
    marks = marks_of(function)
    return [
        name
        for name, each in arguments
        if each.kind is not each.KEYWORD_ONLY and not getattr(marks[name], "option", "")
    ]


_RIG = {"rig": TRIBOMETER}
_ONE = {"model": "kinematic"}
_HEAT = {"pin": "stainless_steel_316", "disc": "aluminium_2024"}
_DOORS: dict[str, tuple[_Door, ...]] = {
    "rig": (
        *(_Door(task, "rig", {}) for task in ("contact", "friction", "wear", "response")),
        _Door("regime", "rig", {"viscosity": "0.1 Pa s"}),
        _Door("thermal", "rig", _HEAT),
        _Door("predict", "rig", {"draws": 200}),
    ),
    "runs": (
        _Door("fit", "runs", _RIG | _ONE),
        _Door("predict", "runs", _RIG | {"draws": 200}),
        _Door("efficiency", "runs", _RIG),
        _Door("mapping", "file", {}),
    ),
    "mapping": (
        _Door("measure friction", "mapping", {"files": _PLAIN}),
        _Door("fit", "mapping", {"runs": str(_EXAMPLES / "tribometer-runs.csv"), **_RIG, **_ONE}),
    ),
    "recording": (
        _Door("measure friction", "files", {}),
        _Door("measure vibration", "files", {"frequency": "10Hz"}),
        _Door("identify decay-length", "file", {}),
    ),
    "spectrum": (_Door("measure impedance", "files", {}),),
    "surface": (
        _Door("measure surface", "files", {}),
        _Door("measure surface", "files", {"length_unit": "um"}),
        _Door("measure surface", "files", {"spacing": "1um"}),
    ),
    "step": (_Door("modes", "part", {"count": 1, "tolerance": "20 %"}),),
    "protocol": (_Door("lab virtual", "protocol", _RIG | {"dry_run": True}),),
    "device_map": (_Door("lab check", "device_map", {}), _Door("lab virtual", "device_map", _RIG | {"dry_run": True})),
    "evidence": (_Door("evidence check", "files", {}), _Door("evidence list", "own", {}, is_list=True)),
    "posterior": (_Door("predict", "evidence", _RIG | {"draws": 200}), _Door("friction", "evidence", _RIG)),
    "record": (_Door("lab show", "run", {}),),
    "test_sheet": (_Door("measure friction", "test_sheet", {"files": _PLAIN}),),
}


def _corpus(room: str) -> list[Path]:
    """Small files of the tests of a room."""
    return sorted((ROOT / "tests" / "measurement" / room / "corpus").iterdir())


_FILES: dict[str, Callable[[], list[Path]]] = {
    "rig": lambda: [path for path in sorted((_EXAMPLES / "rigs").glob("*.toml")) if "modes/" not in path.read_text()],
    "runs": lambda: [_EXAMPLES / "tribometer-runs.csv", _EXAMPLES / "efficiency-runs.csv"],
    "recording": lambda: [*_corpus("recordings"), _EXAMPLES / "decay-length-run.csv"],
    "spectrum": lambda: _corpus("impedance"),
    "surface": lambda: _corpus("surface_files"),
    "protocol": lambda: sorted((ROOT / "src/sonolube/facts/protocol").rglob("*.toml")),
    "device_map": lambda: sorted((_EXAMPLES / "lab").glob("*.toml")),
    "evidence": lambda: sorted((_EXAMPLES / "evidence").glob("*.toml")),
    "test_sheet": lambda: [_EXAMPLES / "test-sheet.toml"],
}


@cache
def _originals(kind: str) -> tuple[tuple[str, bytes], ...]:
    """Names and contents of the undamaged files of a kind."""
    if kind == "step":
        return _made_step()
    if kind == "record":
        return _made_record()
    if kind == "posterior":
        return _made_posterior()
    if kind == "recording":
        return tuple((path.name, path.read_bytes()) for path in _FILES[kind]()) + ((_PLAIN, _plain()),) * 6
    if kind == "mapping":
        return (("mapping.toml", _MAPPING.encode()), ("runs.toml", _RUNS_MAPPING.encode()))
    return tuple((path.name, path.read_bytes()) for path in _FILES[kind]())


def _plain() -> bytes:
    """Short recording of a force and a displacement."""
    rows = [f"{k / 100},{0.4 + 0.02 * (-1) ** k},{k % 10 / 10}" for k in range(500)]
    return "\n".join(["time (s),friction_force (N),tip (um)", *rows]).encode()


def _made_posterior() -> tuple[tuple[str, bytes], ...]:
    """File of the posterior of own published tests."""
    from sonolube.prediction.evidence_posterior import EvidencePosterior, LearnedSource
    from sonolube.prediction.posterior import learned
    from sonolube.prediction.within_plane import plane_posterior

    source = LearnedSource(
        title="Own", citation="Own", opened="full text", points=3, points_within_plane=2, shipped=False
    )
    found = EvidencePosterior(
        hyperparameters=learned().friction.hyperparameters,
        plane_hyperparameters=plane_posterior().hyperparameters,
        fingerprint="1",
        shipped_fingerprint="2",
        sources=(source,),
    )
    return (("posterior.json", found.text().encode()),)


def _made_step() -> tuple[tuple[str, bytes], ...]:
    """Small STEP file."""
    from sonolube.models.fem import block
    from sonolube.models.fem.mesh.geometry import step_text

    return (("block.step", step_text(block(length=0.04, width=0.01, thickness=0.01)).encode()),)


def _made_record() -> tuple[tuple[str, bytes], ...]:
    """Files of the folder of a short run of the virtual laboratory."""
    from sonolube.tasks.lab.protocol_run import virtual

    with tempfile.TemporaryDirectory() as folder:
        virtual(_EXAMPLES / "rigs" / "power_map.toml", protocol=NamedBytes("short.toml", _SHORT), out=folder)
        (run,) = (path for path in Path(folder).iterdir() if path.is_dir())
        return tuple((path.name, path.read_bytes()) for path in sorted(run.iterdir()) if path.is_file())


_SHORT = b"""title = "Short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"

[[steps]]
kind = "acquire"
channels = ["friction_force", "voltage"]
sample_rate = "400 Hz"
duration = "0.4 s"
"""


def _damaged(name: str, content: bytes, rng: random.Random) -> bytes:
    """Content with bytes damaged, or with other values in its entries or cells."""
    if not name.endswith(_TEXTS) or rng.random() < 0.4:
        return mutated(content, rng)
    text = content.decode("utf-8", "surrogateescape")
    for _ in range(rng.choice((1, 1, 2, 4))):
        text = _with_another_value(name, text, rng)
    return text.encode("utf-8", "surrogateescape")


def _with_another_value(name: str, text: str, rng: random.Random) -> str:
    """Text with another value in one entry or cell, or with a line removed or doubled."""
    if rng.random() < 0.2:
        lines = text.splitlines(keepends=True) or [""]
        at = rng.randrange(len(lines))
        lines[at : at + 1] = rng.choice(([], [lines[at]] * 2))
        return "".join(lines)
    pattern = {".toml": r"(?<==)[^\n#]+", ".json": r"(?<=: )[^\n,{}\[\]]+"}.get(Path(name).suffix, r"[^\n,;\t]+")
    places = list(re.finditer(pattern, text))
    if not places:
        return text
    place = rng.choice(places)
    value = rng.choice(_CELLS if name.endswith(".csv") else _VALUES)
    return f"{text[: place.start()]}{value}{text[place.end() :]}"


class _Hangs(BaseException):
    """A call that takes too long."""


def _give_up(*_: object) -> NoReturn:
    raise _Hangs


@contextmanager
def _limited() -> Iterator[None]:
    """End what takes too long."""
    before = signal.signal(signal.SIGALRM, _give_up)
    signal.alarm(_LONGEST)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _outcome(call: Callable[[], object]) -> str:
    """Outcome of a call from Python."""
    try:
        call()
    except UnexpectedFault as fault:
        return str(fault)[:300]
    except SonolubeError as refused:
        text = str(refused)
        return "refused" if text and "\n" not in text and len(text) < 4100 else f"unclear: {text[:300]!r}"
    except MemoryError:
        return "took all memory"
    return "answered"


def _completed(found: Record) -> Record:
    """Record of a command; that a check found something wrong is an answer."""
    return {**found, "outcome": "answered"} if found["outcome"] == "exit code 1: " else found


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    kind = rng.choice([each for each in _DOORS if each != "step"])
    if rng.random() < _MAX_STEPS:
        kind = "step"
    door = rng.choice(_DOORS[kind])
    way = rng.choice(("command", "path") if kind in _ONLY_PATHS else ("command", "path", "bytes"))
    name, content = rng.choice(_originals(kind))
    damaged = _damaged(name, content, rng)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(), _limited():
        warnings.simplefilter("ignore")
        path = Path(folder) / name
        if kind == "record":
            path = Path(folder) / "run" / name
            path.parent.mkdir()
            for other, whole in _originals(kind):
                (path.parent / other).write_bytes(whole)
        path.write_bytes(damaged)
        if name != _PLAIN:
            (Path(folder) / _PLAIN).write_bytes(_plain())
        file = path.parent if kind == "record" else path
        before, tempfile.tempdir = tempfile.tempdir, folder
        try:
            if way == "command":
                found = _completed(program_record(door.command(file, Path(folder))))
            else:
                given = NamedBytes(name, damaged) if way == "bytes" else file
                found = {"outcome": _outcome(lambda: door.call(given, Path(folder))), "slow": False}
        except _Hangs:
            found = {"outcome": "hangs", "slow": True}
        finally:
            tempfile.tempdir = before
    return {**found, "kind": kind, "way": way, "command": door.task}


STUDY = Study(
    title="Damaged files through whole tasks",
    question="A task of Python or a command that takes a damaged rig, table of runs, mapping, recording, spectrum,"
    " surface, STEP file, protocol, device map, file of evidence, posterior, run of the laboratory or test sheet"
    " answers or refuses in one line.",
    sources=("**/*.py",),
    trials=10_000,
    sample=15,
    trial=_trial,
    measures=outcome_measures,
)
