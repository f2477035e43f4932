"""Inputs and outputs of the exported plant and controller, with units and ranges, and their description in XML."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite, pi
from typing import Final, Literal
from xml.sax.saxutils import quoteattr

from sonolube.design.control import FrequencyTracker, FrictionController
from sonolube.design.fmu.plant import PlantTables
from sonolube.rig import VOLTAGE, CommandedQuantity
from sonolube.vocabulary import quantity

Version = Literal["2", "3"]
"""Version of the Functional Mock-up Interface."""

_BASE_UNITS: Final[Mapping[str, Mapping[str, int]]] = {
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "Hz": {"s": -1},
    "m/s": {"m": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "m": {"m": 1},
    "A": {"A": 1},
    "rad": {"rad": 1},
    "K": {"K": 1},
    "s": {"s": 1},
}
_CATEGORIES: Final = ("logStatusWarning", "logStatusDiscard", "logStatusError")


@dataclass(frozen=True, kw_only=True, slots=True)
class Variable:
    """An input or output of an exported unit.

    Parameters
    ----------
    name : str
        Word of the vocabulary, or one made from it.
    unit : str
        SI unit; empty for pure numbers.
    description : str
    is_input : bool
    start : float
        First value of an input, and of an output that changes at samples only.
    lowest, highest : float
        Range in which the unit is valid, infinite where there is none.
    is_sampled : bool
        Whether it is an output that changes at samples only.
    symbol : str
        Name of its place in the C source.
    """

    name: str
    unit: str
    description: str
    is_input: bool = False
    start: float = 0.0
    lowest: float = -inf
    highest: float = inf
    is_sampled: bool = False
    symbol: str = ""

    @property
    def place(self) -> str:
        """Name of its index in the C source."""
        return self.symbol or self.name.upper()


def plant_variables(tables: PlantTables) -> tuple[Variable, ...]:
    """Inputs of a plant, whose ranges are those of its tables, and its outputs.

    Parameters
    ----------
    tables : PlantTables

    Returns
    -------
    tuple of Variable
    """
    ranges, rig, of = tables.ranges, tables.rig, tables.quantity
    assert rig.drive is not None
    inputs = (
        _level(of, start=0.0, highest=ranges.level[1], is_input=True),
        _input("frequency", "Frequency of the drive", rig.drive.frequency, ranges.frequency),
        _input("sliding_speed", "Sliding speed", rig.sliding_speed, ranges.sliding_speed),
        _input("normal_load", "Normal load", rig.normal_load, ranges.normal_load),
    )
    outputs = ["friction_force", "friction_coefficient", "friction_ratio", "vibration_amplitude"]
    outputs += ["peak_current", "phase"] if tables.has_current else []
    outputs += ["temperature_rise"] if tables.heat else []
    return (*inputs, *(_output(name) for name in outputs))


def controller_variables(controller: FrictionController, tracker: FrequencyTracker | None) -> tuple[Variable, ...]:
    """Inputs and outputs of a friction controller, those of its frequency tracker among them.

    Parameters
    ----------
    controller : FrictionController
    tracker : FrequencyTracker or None

    Returns
    -------
    tuple of Variable
    """
    force = controller.intrinsic_friction_force
    found = [
        Variable(
            name="friction_force_setpoint",
            unit="N",
            description="Commanded friction force",
            is_input=True,
            start=force,
            lowest=0.0,
            highest=force,
            symbol="SETPOINT",
        ),
        Variable(name="friction_force", unit="N", description="Friction force as measured", is_input=True, start=force),
    ]
    if tracker is not None:
        text = "Phase of voltage over current as measured, positive where the voltage leads"
        found += [
            Variable(name="phase", unit="rad", description=text, is_input=True, start=-pi / 2, lowest=-pi, highest=pi),
            Variable(
                name="frequency",
                unit="Hz",
                description="Frequency of the drive over the next interval",
                start=tracker.frequency,
                is_sampled=True,
            ),
        ]
    return (*found, _level(controller.quantity, start=0.0, highest=inf, is_input=False))


def _level(of: CommandedQuantity, *, start: float, highest: float, is_input: bool) -> Variable:
    """Voltage or commanded amplitude, as an input of the plant or an output of the controller."""
    text = "Voltage of the drive, peak to peak; its offset goes with it" if of is VOLTAGE else "Commanded amplitude"
    name = of.name if of is VOLTAGE else "vibration_amplitude_setpoint"
    bounds = (0.0, highest) if is_input else (-inf, inf)
    return Variable(
        name=name,
        unit=of.unit,
        description=text,
        is_input=is_input,
        start=start,
        lowest=bounds[0],
        highest=bounds[1],
        is_sampled=not is_input,
        symbol="LEVEL",
    )


def _input(name: str, text: str, start: float, ends: tuple[float, float]) -> Variable:
    return Variable(
        name=name,
        unit=quantity(name).unit,
        description=text,
        is_input=True,
        start=min(max(start, ends[0]), ends[1]),
        lowest=ends[0],
        highest=ends[1],
    )


def _output(name: str) -> Variable:
    of = quantity(name)
    return Variable(name=name, unit=of.unit, description=of.meaning)


@dataclass(frozen=True, kw_only=True, slots=True)
class Description:
    """What a unit says of itself.

    Parameters
    ----------
    identifier : str
        Name of the unit, a word of C.
    title : str
    text : str
    notes : mapping of str to str
        Facts for people and programs: the kind of model, its error.
    step : float
        Step that suits it, in s.
    variables : tuple of Variable
    """

    identifier: str
    title: str
    text: str
    notes: Mapping[str, str]
    step: float
    variables: tuple[Variable, ...]


def model_description(described: Description, *, version: Version, token: str, tool: str) -> str:
    """File `modelDescription.xml` of a unit.

    Parameters
    ----------
    described : Description
    version : {"2", "3"}
    token : str
        GUID, or instantiation token, of the unit's content.
    tool : str
        Program that made it, with its version.

    Returns
    -------
    str
    """
    made = _description_2 if version == "2" else _description_3
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + "\n".join(made(described, token, tool)) + "\n"


def build_description(identifier: str) -> str:
    """File `sources/buildDescription.xml`, by which an importer of FMI 3.0 compiles the sources."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{identifier}">
    <SourceFileSet language="C99">
      <SourceFile name="fmi3.c"/>
    </SourceFileSet>
    <Library name="m"/>
  </BuildConfiguration>
</fmiBuildDescription>
"""


def _attributes(**values: str | float | bool) -> str:
    """Attributes of an element; numbers as Python's shortest texts, from which they are restored exactly."""
    return "".join(f" {name}={quoteattr(_text(value))}" for name, value in values.items())


def _text(value: str | float | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else value if isinstance(value, str) else repr(float(value))


def _bounds(variable: Variable) -> dict[str, str | float]:
    """Unit and range of a variable, and the start of one that has it."""
    found: dict[str, str | float] = {"unit": variable.unit} if variable.unit else {}
    if variable.unit == "K":
        found["relativeQuantity"] = "true"
    if isfinite(variable.lowest):
        found["min"] = variable.lowest
    if isfinite(variable.highest):
        found["max"] = variable.highest
    if variable.is_input or variable.is_sampled:
        found["start"] = variable.start
    return found


def _roles(variable: Variable) -> dict[str, str]:
    """Causality, variability and first value."""
    if variable.is_input:
        return {"causality": "input", "variability": "continuous"}
    if variable.is_sampled:
        return {"causality": "output", "variability": "discrete", "initial": "exact"}
    return {"causality": "output", "variability": "continuous", "initial": "calculated"}


def _shared(described: Description) -> list[str]:
    """Units and categories of messages, which both versions write in one way."""
    units = dict.fromkeys([*(each.unit for each in described.variables if each.unit), "s"])
    return [
        "  <UnitDefinitions>",
        *(f'    <Unit name="{unit}"><BaseUnit{_exponents(unit)}/></Unit>' for unit in units),
        "  </UnitDefinitions>",
        "  <LogCategories>",
        *(f'    <Category name="{name}"/>' for name in _CATEGORIES),
        "  </LogCategories>",
        f"  <DefaultExperiment{_attributes(startTime=0.0, stopTime=1000 * described.step, stepSize=described.step)}/>",
    ]


def _exponents(unit: str) -> str:
    return "".join(f' {base}="{exponent}"' for base, exponent in _BASE_UNITS[unit].items())


def _calculated(variables: Sequence[Variable]) -> list[tuple[int, Variable]]:
    """Outputs with their value references."""
    return [(i + 1, each) for i, each in enumerate(variables) if not each.is_input]


_ABILITIES: Final = {"canHandleVariableCommunicationStepSize": True, "canBeInstantiatedOnlyOncePerProcess": False}


def _description_2(described: Description, token: str, tool: str) -> list[str]:
    head = _attributes(
        fmiVersion="2.0",
        modelName=described.title,
        guid=token,
        description=described.text,
        generationTool=tool,
        variableNamingConvention="flat",
    )
    abilities = _attributes(
        modelIdentifier=described.identifier, **_ABILITIES, canGetAndSetFMUstate=True, canSerializeFMUstate=True
    )
    lines = [
        f"<fmiModelDescription{head}>",
        f"  <CoSimulation{abilities}>",
        '    <SourceFiles><File name="fmi2.c"/></SourceFiles>',
        "  </CoSimulation>",
        *_shared(described),
        '  <VendorAnnotations>\n    <Tool name="sonolube">\n      <facts>',
        *(f"        <fact{_attributes(name=name, value=value)}/>" for name, value in described.notes.items()),
        "      </facts>\n    </Tool>\n  </VendorAnnotations>",
        "  <ModelVariables>",
    ]
    for reference, each in enumerate(described.variables, start=1):
        of = _attributes(name=each.name, valueReference=str(reference), description=each.description, **_roles(each))
        lines.append(f"    <ScalarVariable{of}><Real{_attributes(**_bounds(each))}/></ScalarVariable>")
    lines += ["  </ModelVariables>", "  <ModelStructure>", "    <Outputs>"]
    lines += [f'      <Unknown index="{reference}"/>' for reference, _ in _calculated(described.variables)]
    lines += ["    </Outputs>", "    <InitialUnknowns>"]
    initial = [ref for ref, each in _calculated(described.variables) if not each.is_sampled]
    lines += [f'      <Unknown index="{reference}"/>' for reference in initial] + ["    </InitialUnknowns>"]
    if not initial:
        del lines[-2:]
    return [*lines, "  </ModelStructure>", "</fmiModelDescription>"]


def _description_3(described: Description, token: str, tool: str) -> list[str]:
    head = _attributes(
        fmiVersion="3.0",
        modelName=described.title,
        instantiationToken=token,
        description=described.text,
        generationTool=tool,
        variableNamingConvention="flat",
    )
    abilities = _attributes(
        modelIdentifier=described.identifier, **_ABILITIES, canGetAndSetFMUState=True, canSerializeFMUState=True
    )
    lines = [
        f"<fmiModelDescription{head}>",
        f"  <CoSimulation{abilities}/>",
        *_shared(described),
        "  <ModelVariables>",
        '    <Float64 name="time" valueReference="0" causality="independent" variability="continuous" unit="s"/>',
    ]
    for reference, each in enumerate(described.variables, start=1):
        of = _attributes(name=each.name, valueReference=str(reference), description=each.description, **_roles(each))
        lines.append(f"    <Float64{of}{_attributes(**_bounds(each))}/>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    calculated = _calculated(described.variables)
    lines += [f'    <Output valueReference="{reference}"/>' for reference, _ in calculated]
    lines += [f'    <InitialUnknown valueReference="{ref}"/>' for ref, each in calculated if not each.is_sampled]
    lines += ["  </ModelStructure>", "  <Annotations>"]
    for name, value in described.notes.items():
        lines.append(f'    <Annotation type="sonolube.{name}"><fact{_attributes(value=value)}/></Annotation>')
    return [*lines, "  </Annotations>", "</fmiModelDescription>"]
