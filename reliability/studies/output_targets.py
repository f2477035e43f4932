"""Every command that writes, against targets that must not be replaced."""

import io
import os
import random
import tempfile
import time
from collections.abc import Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import cache
from glob import escape
from pathlib import Path

from reliability.study import Measure, Record, Study
from sonolube.cli import main
from sonolube.cli.app import COMMANDS
from sonolube.cli.console.options import OutputFile, OutputFolder, output_marks

INPUT = "in.dat"
ARGUMENTS = {  # of every command that writes: the least that it takes, in.dat being an input
    "new": ("--scan", INPUT),
    "predict": (INPUT,),
    "simulate": (INPUT,),
    "response": (INPUT,),
    "transient": (INPUT,),
    "thermal": (INPUT, "--pin", "m50", "--disc", "m50"),
    "regime": (INPUT, "--film-coefficient", "0.2", "--asperity-pressure", "10MPa"),
    "modes": (INPUT,),
    "impedance compute": ("stack", "--measured", INPUT),
    "sweep": (INPUT, "--of", "speed"),
    "map": (INPUT,),
    "plan": (INPUT,),
    "mapping": (INPUT,),
    "uncertainty": (INPUT,),
    "optimise": (INPUT, "--target-friction", "0.15"),
    "control": (INPUT,),
    "export fmu": (INPUT,),
    "efficiency": (INPUT, "--rig", "rig.toml"),
    "horn design": (INPUT, "--frequency", "20kHz", "--material", "titanium_6al4v"),
    "horn face": ("steel",),
    "measure friction": (INPUT,),
    "measure rotation": (INPUT, "--groove-diameter", "50mm"),
    "measure temperature": (INPUT,),
    "measure calibration": (INPUT,),
    "measure surface": (INPUT,),
    "measure groove": (INPUT,),
    "measure impedance": (INPUT,),
    "measure vibration": (INPUT, "--frequency", "22kHz"),
    "measure stiffness": (INPUT, INPUT, "--rig", INPUT),
    "lab show": (INPUT,),
    "lab export": (INPUT,),
    "compare": (INPUT,),
    "fit": (INPUT,),
    "identify rig": (INPUT,),
    "runs": ("own.csv", "--add", INPUT),
    "identify decay-length": (INPUT,),
    "evidence plot": (INPUT,),
    "evidence learn": (INPUT,),
    "literature": (INPUT,),
    "reproduce": (),
    "example": ("all",),
}
IN_THE_WAY = ("pipe", "device", "link to a pipe", "dangling link", "loop", "below a file")
KINDS_OF_FILE = ("input", "link to an input", "second name of an input", "folder", *IN_THE_WAY)
KINDS_OF_FOLDER = ("input", "link to an input", *IN_THE_WAY)
KINDS_INSIDE = ("link to an input", "second name of an input", "folder", "pipe", "link to a pipe", "dangling link")
POSITIONAL = ("new",)  # commands whose output is an argument
_LONGEST = 2.0  # s of processor time, all modules being imported before
_STEMS = dict.fromkeys(("rig", "part", "shape", "runs", "run", "pressed", "file", "from_file"), "in") | {
    "of": "speed",
    "kind": "velocity-power",
    "horn": "steel",
}


def hostile(kind: str, path: Path) -> Path:
    """Make a target of a kind, and return it: the path given, but for devices, inputs and what is below a file."""
    if kind == "link to an input":
        path.symlink_to(Path(INPUT).absolute())
    elif kind == "second name of an input":
        path.hardlink_to(INPUT)
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "link to a pipe":
        os.mkfifo("pipe")
        path.symlink_to(Path("pipe").absolute())
    elif kind == "folder":
        path.mkdir()
    elif kind == "dangling link":
        path.symlink_to("nowhere")
    elif kind == "loop":
        path.symlink_to(path.name)
    others = {"input": INPUT, "below a file": f"{INPUT}/page.html", "device": "/dev/null"}
    return Path(others.get(kind, path))


def names_inside(command: str) -> list[str]:
    """Names of files that a command writes in the folder of its option --out."""
    stems = _STEMS | ({"part": "stack"} if command == "impedance compute" else {})
    mark = writers()[command]["out"]
    assert isinstance(mark, OutputFolder)
    filled = mark.names.format_map({key: escape(stem) for key, stem in stems.items()})
    return filled.replace("*", "x").split()


@cache
def writers() -> dict[str, dict[str, OutputFile | OutputFolder]]:
    """Marks of the outputs of every command that has any, by its name."""
    marks = {command.name: output_marks(command.function) for command in COMMANDS}
    return {name: found for name, found in marks.items() if found}


def snapshot() -> dict[str, tuple[int, int, int, int]]:
    """Every file and link of this folder with what changes when it is replaced or written; folders by name alone."""
    found = {path: path.lstat() for path in Path().rglob("*")}
    return {
        str(path): (0, 0, 0, 0) if path.is_dir() else (each.st_ino, each.st_mode, each.st_size, each.st_mtime_ns)
        for path, each in found.items()
    }


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    name = rng.choice(sorted(writers()))
    marks = writers()[name]
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        Path(INPUT).write_bytes(rng.randbytes(rng.randrange(3000)))
        option, target, kind = _target(rng, name, marks)
        before, begin = snapshot(), time.process_time()
        out, err = io.StringIO(), io.StringIO()
        code: object = "did not end"
        try:
            with redirect_stdout(out), redirect_stderr(err):
                main([*name.split(), *ARGUMENTS[name], *([] if name in POSITIONAL else [option]), target])
        except SystemExit as end:
            code = end.code
        text = err.getvalue()
        record = {
            "refused": code == 2 and text.count("\n") == 1 and "cannot be written" in text and not out.getvalue(),
            "kept": snapshot() == before and Path("/dev/null").is_char_device(),
            "soon": time.process_time() - begin < _LONGEST,
        }
        return record if all(record.values()) else {**record, "case": f"{name} {option} {kind}: {code} {text[:200]}"}


def _target(rng: random.Random, name: str, marks: dict[str, OutputFile | OutputFolder]) -> tuple[str, str, str]:
    """Option of the output, a hostile target, and its kind."""
    argument = "report" if "report" in marks else "out"
    if isinstance(marks[argument], OutputFile):
        kind = rng.choice(KINDS_OF_FILE)
        return f"--{argument}", str(hostile(kind, Path("target"))), kind
    reads = INPUT in ARGUMENTS[name]
    if rng.random() < 0.4:
        kind = rng.choice([kind for kind in KINDS_OF_FOLDER if reads or kind != "link to an input"])
        return "--out", str(hostile(kind, Path("target"))), kind
    kind = rng.choice([kind for kind in KINDS_INSIDE if reads or "input" not in kind])
    path = Path("target", rng.choice(names_inside(name)))
    path.parent.mkdir(parents=True)
    hostile(kind, path)
    return "--out", "target", f"{kind} at {path}"


def _measures(records: Sequence[Record]) -> list[Measure]:
    labels = {
        "refused": "targets refused in one line with exit status 2",
        "kept": "trials after which every file, link, pipe and device is as before",
        "soon": f"trials that end within {_LONGEST:g} s of processor time, before anything is computed",
    }
    counts = {key: sum(bool(record[key]) for record in records) for key in labels}
    first = next((f", first: {record['case']}" for record in records if "case" in record), "")
    return [
        Measure(
            label=label,
            value=f"{counts[key]} of {len(records)}{first if counts[key] < len(records) else ''}",
            bar="all",
            holds=counts[key] == len(records),
        )
        for key, label in labels.items()
    ]


STUDY = Study(
    title="Outputs that must not be replaced",
    question="A command is told to write to a pipe, a device, a folder, a broken link, or to its own input under any"
    " name. It refuses in one line before it computes, and destroys nothing.",
    sources=("storage/files.py", "storage/user_files.py", "cli/console/*.py"),
    trials=1000,
    sample=12,
    trial=_trial,
    measures=_measures,
)
