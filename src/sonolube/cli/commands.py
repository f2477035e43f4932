"""Table of all commands, one line each: the panel of the help, the name, and the module with the function."""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.resources import files

_PREDICT = "Predict a rig"
_PART = "Predict a part"
_DESIGN = "Design"
_MEASURE = "Measure"
_COMPARE = "Compare and identify"
_LAB = "Laboratory"
_LOOKUP = "Look up"


@dataclass(frozen=True, slots=True)
class Command:
    """One command of the program.

    Parameters
    ----------
    panel : str
        Heading of the help under which it is listed.
    name : str
        As typed; two words for a command of a group.
    where : str
        Module below `sonolube.cli` and function in it, as "predict.friction:friction".
    """

    panel: str
    name: str
    where: str

    @property
    def function(self) -> Callable[..., None]:
        """Function of the command, imported with its module."""
        module, _, name = self.where.partition(":")
        function: Callable[..., None] = getattr(import_module(f"sonolube.cli.{module}"), name)
        return function

    @property
    def help(self) -> str:
        """Docstring of the function, read from the source without importing the module."""
        module, _, name = self.where.partition(":")
        source = files("sonolube.cli").joinpath(f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        nodes = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef) and node.name == name)
        return ast.get_docstring(next(nodes)) or ""


COMMANDS = (
    Command(_PREDICT, "new", "predict.new:new"),
    Command(_PREDICT, "predict", "predict.predict:predict"),
    Command(_PREDICT, "contact", "predict.contact:contact"),
    Command(_PREDICT, "friction", "predict.friction:friction"),
    Command(_PREDICT, "wear", "predict.wear:wear"),
    Command(_PREDICT, "simulate", "predict.simulate:simulate"),
    Command(_PREDICT, "response", "predict.response:response"),
    Command(_PREDICT, "transient", "predict.transient:transient"),
    Command(_PREDICT, "thermal", "predict.thermal:thermal"),
    Command(_PREDICT, "regime", "predict.regime:regime"),
    Command(_PART, "modes", "predict.modes:modes"),
    Command(_PART, "impedance compute", "predict.impedance:compute"),
    Command(_DESIGN, "sweep", "design.sweep:sweep"),
    Command(_DESIGN, "map", "design.map:map"),
    Command(_DESIGN, "plan", "design.plan:plan"),
    Command(_DESIGN, "uncertainty", "design.uncertainty:uncertainty"),
    Command(_DESIGN, "optimise", "design.optimise:optimise"),
    Command(_DESIGN, "control", "design.control:control"),
    Command(_DESIGN, "efficiency", "design.efficiency:efficiency"),
    Command(_DESIGN, "horn design", "design.horn:design"),
    Command(_DESIGN, "horn face", "design.horn_face:face"),
    Command(_MEASURE, "measure friction", "measure.friction:friction"),
    Command(_MEASURE, "measure rotation", "measure.rotation:rotation"),
    Command(_MEASURE, "measure calibration", "measure.calibration:calibration"),
    Command(_MEASURE, "measure surface", "measure.surface:surface"),
    Command(_MEASURE, "measure groove", "measure.groove:groove"),
    Command(_MEASURE, "measure impedance", "measure.impedance:impedance"),
    Command(_MEASURE, "measure vibration", "measure.vibration:vibration"),
    Command(_MEASURE, "measure stiffness", "measure.stiffness:stiffness"),
    Command(_COMPARE, "compare", "compare.compare:compare"),
    Command(_COMPARE, "fit", "compare.fit:fit"),
    Command(_COMPARE, "identify rig", "compare.identify:identify_rig"),
    Command(_COMPARE, "identify decay-length", "compare.decay_length:decay_length"),
    Command(_COMPARE, "literature", "compare.literature:literature"),
    Command(_COMPARE, "reproduce", "compare.reproduce:reproduce"),
    Command(_LAB, "lab run", "lab.run:run"),
    Command(_LAB, "lab virtual", "lab.virtual:virtual"),
    Command(_LAB, "lab hold", "lab.hold:hold"),
    Command(_LAB, "lab watch", "lab.watch:watch"),
    Command(_LAB, "lab runs", "lab.runs:runs"),
    Command(_LAB, "lab show", "lab.show:show"),
    Command(_LAB, "lab recover", "lab.recover:recover"),
    Command(_LAB, "lab export", "lab.export:export"),
    Command(_LAB, "lab check", "lab.check:check"),
    Command(_LOOKUP, "materials", "lookup.materials:materials"),
    Command(_LOOKUP, "actuators", "lookup.actuators:actuators"),
    Command(_LOOKUP, "published", "lookup.published:published"),
    Command(_LOOKUP, "schema", "lookup.schema:schema"),
    Command(_LOOKUP, "doctor", "lookup.doctor:doctor"),
)

GROUPS = {
    "impedance": "Impedance of piezoelectric parts, by finite elements.",
    "horn": "Design horns and other resonators.",
    "measure": "Measure what instruments recorded: friction, surfaces, spectra, vibration.",
    "lab": "Laboratory: run protocols on a rig, and keep their records.",
    "identify": "Identify the parameters of a rig from facts, and what sets the decay length of a contact.",
}
"""Help of each group of commands."""

MOVED_COMMANDS = {
    "study": "now part of sweep: sonolube sweep RIG.toml --of voltage|speed|frequency|power|waveform|load"
}
"""Commands of earlier versions, each with its replacement."""

RENAMED_OPTIONS = {
    ("friction", "--closure"): "--model",
    ("horn", "--shape"): "the argument PART, such as sonolube horn design stepped_horn",
}
"""Options of earlier versions by the first word of their command, each with its new name."""
