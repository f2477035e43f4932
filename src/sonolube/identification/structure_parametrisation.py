"""Structures with free parameters: the matrices of many at once, from a function that builds one."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from itertools import product

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Bounds, parameter_unit
from sonolube.models.dynamics import Structure

StructureBuilder = Callable[[Mapping[str, float]], Structure]
"""Structure from the values of its free parameters in SI, by name."""

_Arrays = Callable[[Mapping[str, Floats], Mapping[str, float]], Floats]

_MAX_PARAMETERS = 12  # all corners of the bounds are checked
_AFFINE = 1e-9  # largest deviation of an affine array, over its largest element
_MECHANICAL = {"kg": 1.0, "N/m": 1e6, "N s/m": 1e3}  # reference values by SI unit


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StructureMatrices:
    """Matrices of n structures of k coordinates; see `sonolube.models.dynamics.Structure` for their equation of motion.

    Parameters
    ----------
    mass_matrix, damping_matrix, stiffness_matrix : ndarray, shape (n, k, k)
    drive_vector, contact_vector : ndarray, shape (n, k)
    clamped_capacitance : ndarray, shape (n,)
        Capacitance with all coordinates held. [F]
    """

    mass_matrix: Floats
    damping_matrix: Floats
    stiffness_matrix: Floats
    drive_vector: Floats
    contact_vector: Floats
    clamped_capacitance: Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class ParametricStructure:
    """A structure with free parameters.

    Parameters
    ----------
    parameters : tuple of str
        Names of the free parameters.
    matrices : callable
        `StructureMatrices` of n structures from a mapping of each parameter to an array of shape (n,) in SI, and a
        mapping of some of them to what is added to each, such as a hung mass.
    """

    parameters: tuple[str, ...]
    matrices: Callable[[Mapping[str, Floats], Mapping[str, float]], StructureMatrices]


def parametric_structure(build: StructureBuilder, *, reference: Mapping[str, float]) -> ParametricStructure:
    """Parametric structure from a function that builds one structure.

    Parameters
    ----------
    build : callable
        Structure from the values of the free parameters in SI, by name: a chain, modes, or any other.
    reference : mapping of str to float
        Values in SI that make a possible structure, such as by `reference_parameters`; others give the same matrices to
        rounding.

    Returns
    -------
    ParametricStructure

    Raises
    ------
    InvalidInput
        If the reference makes no structure; and by `matrices`, if the parameters are not those of the reference.

    Notes
    -----
    Matrices that are affine functions of the parameters, as those of masses, springs and dampers are, are interpolated
    from a few structures; others, as those of modes whose frequencies are free, are built one by one, some 0.2 ms each.
    """
    names = tuple(reference)
    coordinates = build(reference).coordinates
    evaluate = _affine_arrays(build, reference) or _built_arrays(build, names)

    def matrices(parameters: Mapping[str, Floats], added: Mapping[str, float]) -> StructureMatrices:
        if set(parameters) != set(names):
            raise InvalidInput(f"parameters must be {', '.join(names)}, got {', '.join(parameters)}")
        return _matrices(evaluate(parameters, added), coordinates)

    return ParametricStructure(parameters=names, matrices=matrices)


def reference_parameters(build: StructureBuilder, *, bounds: Bounds) -> dict[str, float]:
    """Reference values for `parametric_structure`, once every corner of the bounds has proved to be a structure.

    Parameters
    ----------
    build : callable
        Structure from the values of the free parameters in SI, by name.
    bounds : mapping of str to pair of float
        Lower and upper bound of each free parameter in SI, both positive; at most 12 parameters.

    Returns
    -------
    dict of str to float
        1 kg, 1e6 N/m or 1 kN s/m for mechanical parameters, the geometric mean of the bounds for others.

    Raises
    ------
    InvalidInput
        If there are more than 12 parameters, or a corner of the bounds is no possible structure, such as a stack whose
        coupling factor would exceed 1.
    """
    if len(bounds) > _MAX_PARAMETERS:
        raise InvalidInput(f"at most {_MAX_PARAMETERS} parameters can be free, got {len(bounds)}; fix some of them")
    for corner in product(*bounds.values()):
        values = dict(zip(bounds, corner, strict=True))
        try:
            build(values)
        except InvalidInput as refusal:
            at = ", ".join(f"{name} {value:.4g} {parameter_unit(name)}".rstrip() for name, value in values.items())
            raise InvalidInput(f"bounds must allow possible structures only, but at {at}: {refusal}") from None
    return {
        name: _MECHANICAL.get(parameter_unit(name), math.sqrt(lower * upper)) for name, (lower, upper) in bounds.items()
    }


def _affine_arrays(build: StructureBuilder, reference: Mapping[str, float]) -> _Arrays | None:
    """Function for the arrays of n structures where these are affine in the parameters, else None.

    Found from the structure at reference values and those with each value doubled, and checked at the triple of all.
    """

    def at(**changed: float) -> Floats:
        return _array(build({**reference, **changed}))

    try:
        origin = at()
        changes = {name: at(**{name: 2 * value}) - origin for name, value in reference.items()}
        tripled = at(**{name: 3 * value for name, value in reference.items()})
    except InvalidInput:  # a doubled stroke or stiffness can make an impossible stack
        return None
    deviation = np.abs(origin + 2 * sum(changes.values()) - tripled)
    if np.any(deviation > _AFFINE * np.maximum(np.abs(tripled), np.abs(origin))):
        return None

    slopes = np.stack(list(changes.values()))

    def arrays(parameters: Mapping[str, Floats], added: Mapping[str, float]) -> Floats:
        growth = np.array([parameters[name] / value - 1 for name, value in reference.items()])
        result = origin + growth.T @ slopes
        for name, value in added.items():
            result += value / reference[name] * changes[name]
        return np.asarray(result)

    return arrays


def _built_arrays(build: StructureBuilder, names: tuple[str, ...]) -> _Arrays:
    """Function for the arrays of n structures, built one by one."""

    def arrays(parameters: Mapping[str, Floats], added: Mapping[str, float]) -> Floats:
        rows = np.stack([parameters[name] + added.get(name, 0.0) for name in names], axis=-1).tolist()
        return np.stack([_array(build(dict(zip(names, row, strict=True)))) for row in rows])

    return arrays


def _array(structure: Structure) -> Floats:
    """All matrices, vectors and the capacitance of a structure in one array."""
    return np.concatenate([np.ravel(getattr(structure, part.name)) for part in fields(StructureMatrices)])


def _matrices(arrays: Floats, coordinates: int) -> StructureMatrices:
    """Matrices of n structures from their arrays, shape (n, 3 k^2 + 2 k + 1)."""
    shapes = (*[(coordinates, coordinates)] * 3, *[(coordinates,)] * 2, ())
    parts = np.split(arrays, np.cumsum([math.prod(shape) for shape in shapes])[:-1], axis=1)
    shaped = [np.ascontiguousarray(part.reshape(-1, *shape)) for part, shape in zip(parts, shapes, strict=True)]
    return StructureMatrices(
        **{part.name: values for part, values in zip(fields(StructureMatrices), shaped, strict=True)}
    )
