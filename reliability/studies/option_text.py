"""Hostile text as the value of an option or an argument of a command."""

import random

from reliability.hostile_text import COLLAR, HOSTILE, ROOT, TRIBOMETER, outcome_measures, program_record
from reliability.study import Record, Study

_RUNS = str(ROOT / "examples" / "efficiency-runs.csv")
_LUBRICANT = ("--film-coefficient", "0.2", "--asperity-pressure", "10MPa")
_SOLIDS = ("--pin", "m50", "--disc", "m50")

# Commands that answer within a second, each with options that take text.
_USES: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (("contact", TRIBOMETER), ("--load", "--set", "contact.normal_load=", "title=")),
    (("friction", COLLAR), ("--load", "--set", "--model", "drive.frequency=", "title=", "friction.model=")),
    (("wear", TRIBOMETER), ("--load", "--set", "contact.roughness.rms_height=")),
    (("response", TRIBOMETER), ("--from", "--to", "--set")),
    (("thermal", TRIBOMETER, *_SOLIDS), ("--pin", "--disc", "--duration", "--heat-capacity", "--conductance", "--set")),
    (("regime", TRIBOMETER, *_LUBRICANT), ("--film-coefficient", "--asperity-pressure", "--smallest-gain", "--pin")),
    (("sweep", TRIBOMETER, "--of", "load", "--points", "2"), ("--from", "--to", "--points", "--of", "--voltage")),
    (("sweep", TRIBOMETER), ("--over", "--of", "drive.frequency=", "friction.model=", "--set")),
    (("optimise", TRIBOMETER), ("--target-friction", "--over", "--bolt", "--horn", "--catalogue", "--actuator")),
    (("control", TRIBOMETER), ("--friction", "--delay", "--rate", "--warming", "--factor", "--feed-forward")),
    (("efficiency", _RUNS), ("--rig", "--target-friction", "--level")),
    (("efficiency", "--rig", TRIBOMETER), ("",)),
    (("uncertainty", TRIBOMETER), ("--of", "--over", "--samples", "--seed", "contact.normal_load=")),
    (("map", TRIBOMETER), ("--over", "--kind", "--measured", "--form")),
    (("modes",), ("", "--set", "--material")),
    (("modes", "block"), ("--set", "length=", "--clamp", "--axis", "--points")),
    (("impedance", "compute", "block"), ("--set", "--from", "--to", "--points", "--ceramic", "--poled")),
    (("horn", "design", "--frequency", "20kHz"), ("", "--material", "--gain", "--amplitude")),
    (("measure", "friction"), ("", "--mapping", "--window", "--sliding-speed", "--torque-constant")),
    (("measure", "surface"), ("", "--spacing", "--length-unit", "--form", "--long-cutoff")),
    (("measure", "impedance"), ("", "--branches", "--sweep", "--stack-of")),
    (("measure", "vibration", _RUNS), ("--frequency", "--modes", "--mapping")),
    (("compare",), ("", "--model")),
    (("literature",), ("",)),
    (("identify", "rig"), ("", "--facts", "--seed")),
    (("materials",), ("",)),
    (("actuators",), ("",)),
    (("published",), ("",)),
    (("schema",), ("", "--out")),
    ((), ("",)),
)


def _words(rng: random.Random) -> list[str]:
    """Arguments of a command with one hostile value."""
    base, options = rng.choice(_USES)
    option, hostile = rng.choice(options), rng.choice(HOSTILE)
    if option.endswith("="):
        flag = "--over" if base[0] in ("sweep", "uncertainty") else "--set"
        return [*base, flag, f"{option}{hostile}"]
    return [*base, option, hostile] if option else [*base, hostile]


def _trial(seed: int) -> Record:
    words = _words(random.Random(seed))
    return {"words": ascii(words[-2:])[:80], **program_record(words)}


STUDY = Study(
    title="Hostile text as an option",
    question="A command whose option or argument is a formula, markup, control characters, bytes that are no UTF-8 or "
    "an endless number or unit answers or refuses in one line, within 5 s.",
    sources=("cli/**/*.py", "text/units.py", "text/unit_grammar.py", "text/plain_text.py"),
    trials=1500,
    sample=20,
    trial=_trial,
    measures=outcome_measures,
)
