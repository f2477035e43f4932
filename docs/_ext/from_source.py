"""Sphinx extension for tables and answers of commands, made from the product when the pages are built.

The comment `<!-- table: NAME -->` on a line of its own is replaced by a table, and a block whose first line is
```` ```{answer} sonolube ... ```` by the command and what it prints.
"""

import io
import re
import shlex
import shutil
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from html import escape
from importlib.resources import files
from inspect import ismodule
from itertools import chain, groupby
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from docutils import nodes
from docutils.parsers.rst import directives
from one_law_scores import HEADS, law_scores, law_verdict
from sentences import first_prediction
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import sonolube
from sonolube.cli import main
from sonolube.cli.app import COMMANDS, Command
from sonolube.facts.materials import (
    DryFriction,
    Material,
    SourcedValue,
    dry_friction_classes,
    dry_friction_pairs,
    material,
    material_classes,
    material_families,
    material_names,
)
from sonolube.facts.published import errata
from sonolube.measurement.impedance.spectrum import IMPEDANCE_FORMATS
from sonolube.measurement.measured_files import FileFormat
from sonolube.measurement.recordings.reader import RECORDING_FORMATS
from sonolube.measurement.run_columns import RUN_COLUMNS
from sonolube.measurement.surface_files.reader import SURFACE_FORMATS
from sonolube.models.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS
from sonolube.models.friction import FRICTION_MODELS
from sonolube.models.surfaces import surface_finish, surface_finish_names
from sonolube.models.wear import WEAR_MODELS
from sonolube.prediction import Calibration, calibrations
from sonolube.prediction.calibration import plane_calibration
from sonolube.prediction.figures import blind_caption, plane_caption
from sonolube.prediction.hierarchy import PROBABILITIES, central_interval
from sonolube.prediction.within_plane import PlaneConditions, coulomb_ratio, plane_rigs
from sonolube.rig import Rig, available_sources, read_rig, rig_schema
from sonolube.rig.file.toml_file import tables_of
from sonolube.text.units import format_si, unit_description
from sonolube.vocabulary import quantities, quantity

DOCS = Path(__file__).parents[1]
RIGS = DOCS.parent / "examples" / "rigs"


def rig_keys() -> str:
    """Tables of a rig file with their keys, as sections."""
    schema = rig_schema()
    return "\n\n".join(_rig_table(name, table, schema) for name, table in _tables("", schema, schema))


def all_commands() -> str:
    """Commands by panel of the help, each with the first line of its help."""
    lines = []
    for panel, called in groupby(COMMANDS, key=lambda command: command.panel):
        rows = [
            [f"[`{each.name}`](#{each.name.replace(' ', '-')})", _plain(each.help.split("\n")[0])] for each in called
        ]
        lines.append(_grid([panel, "Answer"], rows))
    return "\n\n".join(lines)


def _first_line(command: Command) -> str:
    """First line of the help of a command."""
    return _plain(command.help.partition("\n")[0])


def stable_names() -> str:
    """Names of the package itself, and of its groups of tasks."""
    groups = {name: getattr(sonolube, name) for name in sonolube.__all__}
    members = [
        f"`sl.{name}.{each}`" for name, group in groups.items() if ismodule(group) for each in sorted(group.__all__)
    ]
    return ", ".join([f"`sl.{name}`" for name, group in groups.items() if not ismodule(group)] + members)


def example_rigs() -> str:
    """Example rigs with their load, speed and amplitude."""
    rigs = {path.name: read_rig(path) for path in sorted(RIGS.glob("*.toml"))}
    return _grid(
        ["File", "Rig", "Source", "Load", "Speed", "Amplitude", "Assumed"],
        [
            [
                f"`{name}`",
                _plain(rig.title),
                _plain(rig.source),
                format_si(rig.normal_load, "N"),
                format_si(rig.sliding_speed, "m/s"),
                _amplitude(rig),
                f"{len(rig.assumptions)}",
            ]
            for name, rig in rigs.items()
        ],
    )


def _amplitude(rig: Rig) -> str:
    """Return the amplitude of a rig as its file states it, else by which source it is computed."""
    if rig.vibration_amplitude is not None:
        return format_si(rig.vibration_amplitude, "m")
    return rig.amplitude_source or next(iter(available_sources(rig)), "none")


def errata_of_d() -> str:
    """Errata of the dissertation."""
    return _grid(
        ["", "Kind", "Location", "Printed", "Corrected", "Evidence"],
        [
            [each.id, each.kind, *map(_plain, (each.location, each.printed, each.corrected, each.evidence))]
            for each in errata()
        ],
    )


def materials_with_sources() -> str:
    """Materials and classes with their properties and sources, as sections by family."""
    every = [material(name) for name in (*material_names(), *material_classes())]
    return "\n\n".join(
        "\n\n".join([f"## {_words(family)}", *(_material(each) for each in every if each.family == family)])
        for family in material_families()
    )


def dry_friction_by_pair() -> str:
    """Ranges of the coefficient of dry friction by pair of materials or families."""
    rows = [
        [*(", ".join(sorted(map(_words, side))) for side in each.sides), _range(each.friction), _source(each.friction)]
        for each in dry_friction_pairs()
    ]
    return _grid(["", "on", "Coefficient", "Source"], rows)


def dry_friction_by_class() -> str:
    """Ranges of the coefficient of dry friction by class of pairs, the first that fits being taken."""
    known = [each.friction for each in dry_friction_classes()]
    return _grid(
        ["Class of pairs", "Coefficient", "Source"], [[each.pair_class, _range(each), _source(each)] for each in known]
    )


def surface_finishes() -> str:
    """Ranges of Ra of processes and grades."""
    finishes = [surface_finish(name) for name in surface_finish_names()]
    rows = [
        [
            f"`{each.name}`",
            each.title,
            f"{1e6 * each.roughness_average_low:g} to {1e6 * each.roughness_average_high:g} um",
            _plain("; ".join(filter(None, (each.source, each.note)))),
        ]
        for each in finishes
    ]
    return _grid(["Name", "Finish", "Ra", "Source"], rows)


def vocabulary() -> str:
    """Quantities of the vocabulary with symbol and unit."""
    return _grid(
        ["Name", "Symbol", "Unit", "Meaning"],
        [[f"`{each.name}`", f"${each.symbol}$", each.unit, _plain(each.meaning)] for each in quantities().values()],
    )


def glossary() -> str:
    """Quantities of the vocabulary by topic, as definitions."""
    text = files("sonolube").joinpath("vocabulary.toml").read_text(encoding="utf-8")
    parts = re.split(r"^# -- (.*)$", text, flags=re.MULTILINE)[1:]
    return "\n\n".join(_topic(*part) for part in zip(parts[::2], parts[1::2], strict=True))


def _topic(title: str, entries: str) -> str:
    """Quantities of one topic, by their meaning."""
    known = sorted((quantity(name) for name in tomllib.loads(entries)), key=lambda each: each.meaning.lower())
    terms = [f"{_plain(each.meaning)}\n: ${each.symbol}$ {_unit(each.unit)}, `{each.name}`" for each in known]
    return "\n\n".join([f"## {title[0].upper()}{title[1:]}", *terms])


def _unit(unit: str) -> str:
    return f"in {_plain(unit)}" if unit else "(a pure number)"


def recording_formats() -> str:
    """Return every file format of recordings with its suffixes and content."""
    return _formats(RECORDING_FORMATS.values())


def run_columns() -> str:
    """Columns of a table of runs."""
    return _grid(
        ["Column", "Meaning", "Needed"],
        [[f"`{column.heading}`", _plain(column.meaning), _plain(column.needed)] for column in RUN_COLUMNS],
    )


def impedance_formats() -> str:
    """Return every file format of impedance spectra with its suffixes and content."""
    return _formats(IMPEDANCE_FORMATS.values())


def surface_formats() -> str:
    """Return every file format of surfaces with its suffixes and content."""
    return _formats(SURFACE_FORMATS.values())


def asperity_laws() -> str:
    """Return every asperity law with its first docstring line and its source."""
    return _variants("`asperity_law`", "Law", {name: (type(law), law.citation) for name, law in ASPERITY_LAWS.items()})


def height_distributions() -> str:
    """Return every height distribution with its first docstring line and its source."""
    known = {name: (type(heights), heights.citation) for name, heights in HEIGHT_DISTRIBUTIONS.items()}
    return _variants("`height_distribution`", "Distribution", known)


def friction_models() -> str:
    """Return every friction model with its first docstring line, its parameters and its source."""
    rows = []
    for name, model in FRICTION_MODELS.items():
        parameters = [f"`{each.name}` [{each.unit or '-'}]" for each in model.parameters()]
        rows.append([f"`{name}`", _plain(_summary(model)), ", ".join(parameters), _plain(model.citation)])
    return _grid(["`model`", "Model", "Parameters", "Source"], rows)


def wear_models() -> str:
    """Return every wear model with its first docstring line."""
    return _grid(["Name", "Model"], [[f"`{name}`", _plain(_summary(model))] for name, model in WEAR_MODELS.items()])


_CALIBRATION_HEADS = (
    *("Prediction", *(f"{100 * each:.0f} %, tests (rigs)" for each in PROBABILITIES)),
    *("CRPS", "Score", "Width", "Fall by the blind"),
)


def prediction_calibration() -> str:
    """Coverage and scores of ways to predict published tests unseen."""
    return _grid(_CALIBRATION_HEADS, map(_calibration_cells, calibrations()))


def blind_calibration() -> str:
    """Coverage and scores of the blind prediction and of the mean ratio."""
    return _grid(_CALIBRATION_HEADS, map(_calibration_cells, calibrations()[:2]))


def _calibration_cells(one: Calibration) -> list[str]:
    coverages = [
        f"{one.covered(each)}/{len(one.predictions)} ({one.rigs_covered(each)}/{one.rigs})" for each in PROBABILITIES
    ]
    scores = [f"{one.crps:.3f}", f"{one.interval_score:.2f}", f"{one.median_width:.2f}"]
    rigs = {each.rig for each in one.predictions}
    gain, low, high = calibrations()[0].of_rigs(lambda rig: rig in rigs).gain_over(one)
    fall = "" if one is calibrations()[0] else f"{gain:.3f} ({low:.3f} to {high:.3f})"
    return [one.name, *coverages, *scores, fall]


def blind_headline() -> str:
    """Coverage and score of the blind prediction in words."""
    return blind_caption()


def blind_plane() -> str:
    """Each published point within the plane with the rigid law and the prediction by the points on other rigs."""
    rows = []
    points = [(rig, place) for rig in plane_rigs() for place in range(rig.friction_ratio.size)]
    for (rig, place), one in zip(points, plane_calibration().predictions, strict=True):
        ends = [central_interval(one.draws, probability) for probability in PROBABILITIES]
        at = rig.at.conditions
        assert isinstance(at, PlaneConditions)
        zeta = float(at.velocity_ratio[place])
        rigid = float(coulomb_ratio(at.direction, velocity_ratio=zeta))
        numbers = [f"{zeta:.2g}", f"{one.friction_ratio:.2f}", f"{rigid:.2g}", f"{np.median(one.draws):.2f}"]
        rows.append([rig.name, *numbers, *(f"{low:.2f} to {high:.2f}" for low, high in ends)])
    intervals = [f"{100 * each:.0f} %" for each in PROBABILITIES]
    return _grid(["Point", "v_r/(omega a)", "Measured", "Rigid contact", "Median", *intervals], rows)


def blind_plane_headline() -> str:
    """How far predictions within the plane were tested, in words."""
    return plane_caption()


def one_law() -> str:
    """Blind scores of one law for all directions beside those of the laws that ship."""
    return _grid(HEADS, [one.row for one in law_scores()])


def one_law_verdict() -> str:
    """By how much the laws that were tried are worse than those that ship."""
    return law_verdict(law_scores())


TABLES: Mapping[str, Callable[[], str]] = {
    table.__name__: table
    for table in (
        all_commands,
        stable_names,
        rig_keys,
        example_rigs,
        errata_of_d,
        materials_with_sources,
        dry_friction_by_pair,
        dry_friction_by_class,
        surface_finishes,
        vocabulary,
        glossary,
        recording_formats,
        run_columns,
        impedance_formats,
        surface_formats,
        asperity_laws,
        height_distributions,
        friction_models,
        wear_models,
        prediction_calibration,
        blind_calibration,
        blind_headline,
        blind_plane,
        blind_plane_headline,
        one_law,
        one_law_verdict,
        first_prediction,
    )
}


class Answer(SphinxDirective):
    """Directive for a command and its output, run in a folder with `examples` and `my-rig.toml`.

    With the option `refused` the command must end with exit code 2; with `continues` it runs in the folder of the one
    before on its page.
    """

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar = {"refused": directives.flag, "continues": directives.flag}
    folders: ClassVar[dict[str, tempfile.TemporaryDirectory[str]]] = {}

    def run(self) -> list[nodes.Node]:
        """Block of text with the command and its output."""
        self.env.note_reread()
        command = self.arguments[0]
        name = self.env.docname
        if "continues" not in self.options or name not in self.folders:
            self.folders[name] = scratch_folder()
        code, printed = answer(command, Path(self.folders[name].name))
        if code != (2 if "refused" in self.options else 0):
            raise self.error(f"exit code {code}:\n{printed}")
        lines = [_line("command", f"$ {command}"), *(_line(_kind(line), line) for line in printed.splitlines())]
        return [nodes.raw("", f'<pre class="answer">{"".join(lines)}</pre>', format="html")]


def _line(kind: str, text: str) -> str:
    """Line of an answer in HTML."""
    return f'<span class="{kind}">{escape(text, quote=False)}</span>'


def _kind(line: str) -> str:
    """Whether a line of an answer is a row of a table, which keeps its columns, or text, which wraps."""
    columns = re.split(r"\s{2,}", line.strip())
    return "row" if len(columns) > 2 else "text"


def answer(command: str, folder: Path) -> tuple[object, str]:
    """Exit code and output of a command in a folder, standard error included."""
    printed = io.StringIO()
    with chdir(folder), redirect_stdout(printed), redirect_stderr(printed):
        try:
            main(shlex.split(command)[1:])
        except SystemExit as end:
            return end.code, printed.getvalue().rstrip()
    raise AssertionError("a command ends by exiting")


def scratch_folder() -> tempfile.TemporaryDirectory[str]:
    """Temporary folder in which the commands of the pages run as printed."""
    folder = tempfile.TemporaryDirectory()
    (Path(folder.name) / "examples").symlink_to(RIGS.parent)
    shutil.copy(DOCS / "my-rig.toml", folder.name)
    return folder


def fill(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace the comments that name tables by the tables, before a page is parsed."""
    filled = re.sub(r"^<!-- table: (\w+) -->$", lambda match: TABLES[match[1]](), source[0], flags=re.MULTILINE)
    if filled != source[0]:
        app.env.note_reread()
    source[0] = filled


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive and the tables with Sphinx."""
    app.add_directive("answer", Answer)
    app.connect("source-read", fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _tables(name: str, table: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    yield name, table
    for key, entry in table.get("properties", {}).items():
        for inner in _inner_tables(entry, schema):
            yield from _tables(f"{name}.{key}".lstrip("."), inner, schema)


def _inner_tables(entry: Mapping[str, Any], schema: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [schema["$defs"][name] for name in tables_of(entry)]


def _rig_table(name: str, table: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    kind = table.get("properties", {}).get("kind", {}).get("const")
    heading = f"### `[{name}]`{f', `kind = {chr(34)}{kind}{chr(34)}`' if kind else ''}" if name else "### At the top"
    required = table.get("required", ())
    rows = [
        [f"`{key}`", *_key(key, entry), _need(key, entry, required)]
        for key, entry in table.get("properties", {}).items()
        if not _inner_tables(entry, schema)
    ]
    description = table.get("description", "")
    grid = _grid(["Key", "Meaning", "Unit", "Write", ""], rows) if rows else ""
    return "\n\n".join(filter(None, [heading, description, grid]))


def _key(key: str, entry: Mapping[str, Any]) -> tuple[str, str, str]:
    if "x-si-unit" in entry:
        unit = entry["x-si-unit"]
        return _plain(entry["title"]), unit or "none", _plain(unit_description(unit))
    if entry.get("description") or entry.get("const"):
        return (
            _plain(entry.get("description") or key.capitalize()),
            "",
            f"`{entry.get('const', '')}`".strip("`") or "see the text",
        )
    if "enum" in entry:
        return key.replace("_", " ").capitalize(), "", "one of " + ", ".join(f"`{name}`" for name in entry["enum"])
    if any(option.get("type") == "array" for option in entry.get("anyOf", [entry])):
        return key.replace("_", " ").capitalize(), "", "numbers, such as `[0, 1, 0.5]`"
    if entry.get("type") == "object":
        return "What no source gives, by key", "", "a reason for each key"
    return key.capitalize(), "", "text"


def _need(key: str, entry: Mapping[str, Any], required: Sequence[str]) -> str:
    if key in required:
        return "required"
    default = entry.get("default")
    return "optional" if default is None or default == {} else f"default `{default}`"


def _formats(formats: Iterable[FileFormat]) -> str:
    rows = [
        [
            f"`{one.name}`",
            ", ".join(f"`{suffix}`" for suffix in one.suffixes),
            _plain((type(one).__doc__ or "").partition("\n")[0]),
        ]
        for one in formats
    ]
    return _grid(["Format", "Suffixes", "Content"], rows)


def _material(shown: Material) -> str:
    rows = [
        [key.replace("_", " "), format_si(known.value, known.unit, digits=4), _source(known)]
        for key, known in shown.properties.items()
    ]
    if shown.crystal_structure:
        structure = shown.crystal_structure
        rows.append(["crystal structure", _plain(structure.text), _plain(structure.source)])
    names = ", ".join(f"`{name}`" for name in (shown.name, *shown.aliases))
    return f"### {_plain(shown.title)}\n\n{names}\n\n" + _grid(["Property", "Value", "Source"], rows)


def _words(name: str) -> str:
    """Return a name with spaces and a capital."""
    return name.replace("_", " ").capitalize()


def _range(known: DryFriction) -> str:
    return f"{known.low:g} to {known.high:g}"


def _source(known: SourcedValue | DryFriction) -> str:
    return _plain("; ".join(filter(None, (known.source, known.condition, known.note))))


def _variants(key: str, kind: str, known: Mapping[str, tuple[Any, str]]) -> str:
    """Return a table of named variants from their records and citations."""
    rows = [[f"`{name}`", _plain(_summary(record)), _plain(citation)] for name, (record, citation) in known.items()]
    return _grid([key, kind, "Source"], rows)


def _summary(record: Any) -> str:
    """Return the first line of a docstring, without its full stop and its unit."""
    return re.sub(r"\s*\[\]$", "", (record.__doc__ or "").strip().splitlines()[0]).removesuffix(".")


def _grid(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = chain([heads, ["---"] * len(heads)], rows)
    return "\n".join("| " + " | ".join(cell.replace("\n", " ") for cell in line) + " |" for line in lines)


def _plain(text: str) -> str:
    """Text with the special characters of Markdown escaped."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)
