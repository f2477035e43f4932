"""Table of all tasks, one line each: panel of the help, name, module and function, and the files of its answer.

Docstrings for help texts are read from the source, without their section `Examples` and without an import.
"""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from sonolube.tasks.answer import Answer

_EXAMPLES: Final = "\n\nExamples\n--------\n"


def docstring(package: str, where: str) -> str:
    """Docstring, without examples, of a function such as "predict.rig_record:wear"; its module is not imported."""
    module, _, name = f"{package}.{where}".strip(".").partition(":")
    root, _, inner = module.partition(".")
    source = files(root).joinpath(f"{inner.replace('.', '/')}.py").read_text(encoding="utf-8")
    nodes = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef) and node.name == name)
    return split_examples(ast.get_docstring(next(nodes)) or "")[0]


def split_examples(text: str) -> tuple[str, str]:
    """Docstring without its section Examples, which has `>>>` of Python, and that section."""
    before, heading, examples = text.partition(_EXAMPLES)
    return before, f"{heading}{examples}".strip()


PREDICT: Final = "Predict a rig"
_PART: Final = "Predict a part"
_DESIGN: Final = "Design"
_MEASURE: Final = "Measure"
_COMPARE: Final = "Compare and identify"
LAB: Final = "Laboratory"
LOOKUP: Final = "Look up"


@dataclass(frozen=True, slots=True)
class Task:
    """One task.

    Parameters
    ----------
    panel : str
        Heading under which it is listed.
    name : str
        As typed on a terminal; two words for a task of a group, in Python joined by a dot.
    where : str
        Module below `sonolube.tasks` and function in it, as "predict.rig_record:friction".
    writes : str
        Names of the files of its answer with spaces between, * for what is not known before the computation; an
        argument in braces stands for its name without folder and ending.
    has_report : bool
        Whether the page of its answer is written on request, under a name of its own.
    folder : str
        Folder of the files where none is named, which is not tried before the task runs; empty for the usual one.
    writes_on_request : bool
        Whether the files are written only where a folder is named.
    """

    panel: str
    name: str
    where: str
    writes: str = ""
    has_report: bool = False
    folder: str = ""
    writes_on_request: bool = False

    @property
    def function(self) -> "Callable[..., Answer]":
        """Function of the task, imported with its module."""
        module, _, name = self.where.partition(":")
        function: Callable[..., Any] = getattr(import_module(f"sonolube.tasks.{module}"), name)
        return function

    @property
    def summary(self) -> str:
        """Docstring of the function, read from the source without importing the module."""
        return docstring("sonolube.tasks", self.where)


TASKS: Final = (
    Task(PREDICT, "new", "predict.new:new"),
    Task(PREDICT, "predict", "predict.predict:predict", "{rig}-prediction.*"),
    Task(PREDICT, "contact", "predict.rig_record:contact"),
    Task(PREDICT, "friction", "predict.rig_record:friction"),
    Task(PREDICT, "wear", "predict.rig_record:wear"),
    Task(PREDICT, "simulate", "predict.rig_record:simulate", "{rig}-simulation.*"),
    Task(PREDICT, "response", "predict.response_and_regime:response", "{rig}-response.*"),
    Task(PREDICT, "transient", "predict.response_and_regime:transient", "{rig}-transient.*"),
    Task(PREDICT, "thermal", "predict.rig_record:thermal", "{rig}-thermal.*"),
    Task(PREDICT, "regime", "predict.response_and_regime:regime", "{rig}-regime.*"),
    Task(
        _PART,
        "modes",
        "parts.modes:modes",
        "{part}-*.png {part}-*.gif {part}-shapes.csv {part}-modes.* {from_file}-modes.toml",
    ),
    Task(
        _PART,
        "impedance compute",
        "impedance.computed_impedance:compute",
        "{part}-impedance.* {part}-impedance-free.* {part}-impedance-clamped.* {part}-modes-*.vtu",
    ),
    Task(
        _DESIGN,
        "sweep",
        "design.sweep:sweep",
        "sweep.nc sweep.json sweep.html sweep.png sweep.svg sweep.pdf {rig}-{of}.*",
    ),
    Task(_DESIGN, "map", "design.map:map", "map.html {rig}-velocity-*.* {rig}-frequency-*.*"),
    Task(_DESIGN, "plan", "design.plan:plan", "{rig}-plan.* {rig}-plan-runs.csv {rig}-plan/*"),
    Task(_DESIGN, "uncertainty", "design.uncertainty:uncertainty", "uncertainty.html {rig}-uncertainty-*.*"),
    Task(_DESIGN, "optimise", "design.optimise:optimise", "optimise.html {rig}-optimum.* {rig}-optimum-*.*"),
    Task(_DESIGN, "control", "design.control:control", "control.html {rig}-control.* {rig}-control-*.*"),
    Task(_DESIGN, "export fmu", "export.mock_up:fmu", "{rig}-plant.fmu {rig}-controller.fmu"),
    Task(_DESIGN, "efficiency", "design.efficiency:efficiency", "efficiency.html {runs}-efficiency.*"),
    Task(_DESIGN, "horn design", "horn.horns:design", "{part}-axis.* {part}-mode.* {part}-drawing.* {part}-tuned.step"),
    Task(_DESIGN, "horn face", "horn.horns:face", "horn-{horn}-face.*"),
    Task(_MEASURE, "runs", "measure.own_runs:runs"),
    Task(_MEASURE, "measure friction", "measure.recordings:friction", has_report=True),
    Task(_MEASURE, "measure rotation", "measure.recordings:rotation", has_report=True),
    Task(_MEASURE, "measure temperature", "measure.recordings:temperature", has_report=True),
    Task(_MEASURE, "measure calibration", "measure.recordings:calibration", has_report=True),
    Task(_MEASURE, "measure surface", "measure.scanned_surface:surface", has_report=True),
    Task(_MEASURE, "measure groove", "measure.worn_groove:groove", has_report=True),
    Task(_MEASURE, "measure impedance", "measure.spectra:impedance", has_report=True),
    Task(_MEASURE, "measure vibration", "measure.recordings:vibration", has_report=True),
    Task(_MEASURE, "measure stiffness", "measure.spectra:stiffness", "{pressed}-stiffness.*"),
    Task(_COMPARE, "compare", "compare.compare:compare", "models.csv models.nc models-*.*"),
    Task(_COMPARE, "fit", "compare.compare:fit", "{runs}-fit.*"),
    Task(_COMPARE, "identify rig", "identify.rig_of_facts:rig"),
    Task(_COMPARE, "identify decay-length", "identify.decay_length_of_run:decay_length", "{file}-decay-length.*"),
    Task(_COMPARE, "evidence list", "evidence.published_tests:list"),
    Task(_COMPARE, "evidence check", "evidence.published_tests:check"),
    Task(_COMPARE, "evidence plot", "evidence.published_tests:plot", "evidence.*"),
    Task(_COMPARE, "evidence learn", "evidence.learned_posterior:learn"),
    Task(_COMPARE, "literature", "compare.literature:literature", "map-of-studies.* studies.csv"),
    Task(_COMPARE, "reproduce", "compare.reproduce:reproduce", "reproduction.html validation.json figures/*"),
    Task(LAB, "lab run", "lab.protocol_run:run"),
    Task(LAB, "lab virtual", "lab.protocol_run:virtual"),
    Task(LAB, "lab hold", "lab.friction_hold:hold"),
    Task(LAB, "lab runs", "lab.run_folders:runs"),
    Task(LAB, "lab show", "lab.run_folders:show", "{run}-channels.* {run}-channels-*", writes_on_request=True),
    Task(LAB, "lab recover", "lab.run_folders:recover"),
    Task(LAB, "lab export", "lab.run_folders:export", "{run}.* {run}-*"),
    Task(LAB, "lab check", "lab.device_check:check"),
    Task(LAB, "lab try-driver", "lab.driver_trial:try_driver"),
    Task(LOOKUP, "materials", "lookup.facts:materials"),
    Task(LOOKUP, "actuators", "lookup.facts:actuators"),
    Task(LOOKUP, "published", "lookup.facts:published"),
    Task(
        LOOKUP,
        "example",
        "lookup.example:example",
        "examples/*.csv examples/*.toml examples/evidence/*.toml examples/facts/*.toml examples/lab/*.*"
        " examples/mappings/*.toml examples/protocols/*.toml examples/rigs/*.toml examples/rigs/modes/*.toml",
        folder=".",
    ),
    Task(LOOKUP, "mapping", "lookup.mapping:mapping", "{file}-mapping.toml"),
    Task(LOOKUP, "schema", "lookup.schema:schema"),
)
"""Every task, in the order of the help."""


def task_named(name: str) -> Task:
    """Task of a name, such as "measure friction"."""
    return next(each for each in TASKS if each.name == name)
