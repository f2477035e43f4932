"""Lists in the scripts of the pages that repeat a table of the program name all that the table has."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

import pytest
from tests.test_repeated_lists import choices

from sonolube.browser.answers import _block_object
from sonolube.browser.jobs import ACTIVE
from sonolube.browser.take_away import _FORMS
from sonolube.charts.chart import Part
from sonolube.facts.protocol import STEP_KINDS
from sonolube.laboratory.states import OUTCOMES, State
from sonolube.measurement.file_kind import FileKind
from sonolube.report.blocks import Block, Rows, Table, Verbatim
from sonolube.report.measured.scan import ShownHeights
from sonolube.tasks.measure.spectra import impedance

STATIC = Path(__file__).parents[2] / "src" / "sonolube" / "browser" / "static"
ENDED = {State.SAFE.value, State.FAILED.value}
AT_WORK = {state.value for state in State} - ENDED - {State.IDLE.value}
PARTS = {part.__name__.lower() for part in get_args(Part)}
BLOCKS: tuple[Any, ...] = (Rows(rows=()), Table(heads=(), rows=()), Verbatim(text=""), "")


def source(name: str) -> str:
    return (STATIC / "scripts" / name).read_text(encoding="utf-8")


def body(name: str, begin: str) -> str:
    """What stands between the bracket at the end of the beginning of a list and the one that closes it."""
    text = source(name)
    at = text.index(begin) + len(begin)
    depth = 1
    for place in range(at, len(text)):
        depth += {"[": 1, "{": 1, "(": 1, "]": -1, "}": -1, ")": -1}.get(text[place], 0)
        if depth == 0:
            return text[at:place]
    raise AssertionError(begin)


def texts(name: str, begin: str) -> set[str]:
    """Texts of a list."""
    return set(re.findall(r"'([^']+)'", body(name, begin)))


def heads(name: str, begin: str) -> set[str]:
    """First texts of the lists of a list."""
    return set(re.findall(r"\['([^']+)'", body(name, begin)))


def keys(name: str, begin: str) -> set[str]:
    """Keys of an object."""
    flat = body(name, begin)
    while flat != (flat := re.sub(r"[\[({][^\[\](){}]*[\])}]", "", flat)):
        pass
    return {each.strip().partition(":")[0] for each in flat.split(",") if each.strip()}


LISTS: Mapping[str, tuple[set[str], set[str]]] = {
    "states of a job that has not ended": (texts("job.js", "isActive = (job) => ["), {*ACTIVE}),
    "states of a run that has not ended": (texts("lab/lab.js", "isAtWork = (run) => ["), AT_WORK),
    "signs of states and outcomes of a run": (
        keys("lab/run.js", "const SIGNS = {"),
        AT_WORK | ENDED | {*OUTCOMES.values()} | {"lost", "refused"},
    ),
    "kinds of files": (keys("pages/data.js", "const KINDS = {"), {*get_args(FileKind)}),
    "residuals of an impedance fit": (heads("data/spectrum.js", "const RESIDUALS = ["), choices(impedance, "residual")),
    "circuits of an impedance fit": (heads("data/spectrum.js", "const CIRCUITS = ["), choices(impedance, "circuit")),
    "heights of a scan": (heads("data/scan.js", "const HEIGHTS = ["), {*get_args(ShownHeights)}),
    "forms to take away": (heads("take-away.js", "const FORMS = ["), {*_FORMS}),
    "kinds of blocks of an answer": (
        keys("answer.js", "const BLOCKS = {"),
        {_block_object(each)["kind"] for each in BLOCKS},
    ),
    "parts of a chart that are drawn": (keys("chart-draw.js", "const draw = {"), PARTS),
    "parts of a chart that an axis holds": (keys("chart-scale.js", "const VALUES = {"), PARTS),
    "pages with a style of their own": (
        texts("main.js", "const STYLED = new Set(["),
        {path.stem for path in (STATIC / "pages").glob("*.css")} & keys("state.js", "export const PAGES = {"),
    ),
    "pages": (
        keys("state.js", "export const PAGES = {"),
        {path.stem.removesuffix("-rig") for path in (STATIC / "scripts" / "pages").glob("*.js")},
    ),
}


@pytest.mark.parametrize("name", LISTS)
def test_a_list_of_a_script_has_all_of_the_table(name: str) -> None:
    listed, table = LISTS[name]
    assert listed == table


def test_the_blocks_above_are_of_every_kind() -> None:
    assert {type(each) for each in BLOCKS} == {*get_args(Block)}


@pytest.mark.parametrize("path", sorted((STATIC / "scripts" / "lab").glob("*.js")), ids=lambda path: path.name)
def test_no_script_of_the_laboratory_names_a_kind_of_step(path: Path) -> None:
    quoted = re.findall(r"['\"`]([a-z_]+)['\"`]", path.read_text(encoding="utf-8"))
    named = re.findall(r"[{,] *([a-z]+_[a-z_]+):", path.read_text(encoding="utf-8"))
    kinds = {*STEP_KINDS} - {"prompt", "repeat"}  # words of a dialogue, and of a lane
    assert {*quoted, *named} & kinds == set()
