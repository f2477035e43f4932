"""Forward models of structures: which observable was observed under which conditions, for each fact."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification.fact import Bounds, Fact, ForwardModel, parameter_unit
from sonolube.identification.observables import OBSERVABLES, Observable, observable_named
from sonolube.identification.small_vibration import Conditions, SmallVibration
from sonolube.identification.structure_parametrisation import ParametricStructure

_Evaluate = Callable[[Mapping[str, Floats], Mapping[Conditions, SmallVibration]], Floats]


@dataclass(frozen=True, kw_only=True, slots=True)
class Observation:
    """An observable and the conditions under which it was observed.

    Parameters
    ----------
    observable : str
        Name of an observable of the structure (see `observable_named`); or the name of a free parameter, which is then
        observed itself; or two such names with "/" between, for their ratio.
    conditions : Conditions
    """

    observable: str
    conditions: Conditions = field(default_factory=Conditions)


@dataclass(frozen=True, kw_only=True, slots=True)
class IdentificationProblem:
    """Facts about a structure, what each of them observes, and the free parameters with their bounds.

    Parameters
    ----------
    facts : tuple of Fact
    observations : mapping of str to Observation
        Of each fact, by its name.
    bounds : mapping of str to pair of float
        Lower and upper bound of each free parameter in SI, by name.
    title : str
        Name of the system.
    source : str
        Reference of the facts.
    """

    facts: tuple[Fact, ...]
    observations: Mapping[str, Observation]
    bounds: Bounds
    title: str = ""
    source: str = ""


def structure_model(structure: ParametricStructure, observations: Mapping[str, Observation]) -> ForwardModel:
    """Forward model of a parametric structure for given observations.

    Parameters
    ----------
    structure : ParametricStructure
    observations : mapping of str to Observation
        By the name of the fact.

    Returns
    -------
    callable
        Takes a mapping of each free parameter to an array of shape (n,) in SI and returns one of each name of
        `observations` to an array of that shape. Raises InvalidInput if the parameters are not those of the structure.

    Raises
    ------
    InvalidInput
        If a condition that an observable requires is missing.
    UnknownName
        If an observable or the parameter of an added mass is unknown.
    """
    evaluators = {name: _evaluator(each, structure.parameters, fact=name) for name, each in observations.items()}
    added = {
        each.conditions: {each.conditions.added_to: each.conditions.added_mass} if each.conditions.added_mass else {}
        for each in observations.values()
    }

    def model(parameters: Mapping[str, Floats]) -> Mapping[str, Floats]:
        vibrations = {
            conditions: SmallVibration(structure.matrices(parameters, masses), conditions)
            for conditions, masses in added.items()
        }
        return _Observables(evaluators, parameters, vibrations)

    return model


def observable_unit(observable: str, parameters: Mapping[str, object]) -> str:
    """SI unit of an observable, a free parameter or a ratio of two of them; empty for a pure number.

    Parameters
    ----------
    observable : str
        As in `Observation`.
    parameters : mapping of str to object
        Free parameters, by name.

    Returns
    -------
    str

    Raises
    ------
    UnknownName
        If it is neither an observable nor a parameter.
    InvalidInput
        If it is a ratio of parameters of different units.
    """
    names = observable.split("/")
    if len(names) == 2 and set(names) <= set(parameters):
        first, second = map(parameter_unit, names)
        if first != second:
            raise InvalidInput(f"{observable} is a ratio of {first} and {second}; take two parameters of one unit")
        return ""
    return parameter_unit(observable) if observable in parameters else _observable(observable, parameters).unit


class _Observables(Mapping[str, Floats]):
    """Observables by name, each computed when it is first asked for: a search of few facts asks for few."""

    def __init__(
        self,
        evaluators: Mapping[str, _Evaluate],
        parameters: Mapping[str, Floats],
        vibrations: Mapping[Conditions, SmallVibration],
    ) -> None:
        self._evaluators, self._arguments = evaluators, (parameters, vibrations)
        self._known: dict[str, Floats] = {}

    def __getitem__(self, name: str) -> Floats:
        if name not in self._known:
            self._known[name] = self._evaluators[name](*self._arguments)
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._evaluators)

    def __len__(self) -> int:
        return len(self._evaluators)


def _evaluator(observation: Observation, parameters: tuple[str, ...], *, fact: str) -> _Evaluate:
    """Function of the parameters and the vibrations under each set of conditions, checked beforehand."""
    name, conditions = observation.observable, observation.conditions
    if conditions.added_mass and conditions.added_to not in parameters:
        raise UnknownName.among(parameters, kind="free parameter", name=conditions.added_to)
    numerator, _, denominator = name.partition("/")
    if {numerator, denominator} <= set(parameters):
        return lambda values, _: values[numerator] / values[denominator]
    if name in parameters:
        return lambda values, _: values[name]
    observable = _observable(name, parameters)
    for required in observable.requires:
        if getattr(conditions, required) is None:
            raise InvalidInput(f"fact {fact}: {name} requires the condition {required}; give it")
    return lambda _, vibrations: observable.evaluate(vibrations[conditions])


def _observable(name: str, parameters: Mapping[str, object] | tuple[str, ...]) -> Observable:
    """Observable of a name, or a refusal that lists the parameters as well."""
    try:
        return observable_named(name)
    except UnknownName:
        raise UnknownName.among([*OBSERVABLES, *parameters], kind="observable", name=name) from None
