r"""Complete linear constants of piezoelectric ceramics, in the strain-charge and stress-charge forms of IEEE Std 176.

The ceramic is poled along axis 3. In Voigt notation, stresses T and strains S are ordered 11, 22, 33, 23, 13, 12, the
last three being engineering shear strains. With the electric field E and the charge density D,

.. math::

    S = s^E T + d^{\mathsf T} E , \quad D = d\,T + \varepsilon^T E \qquad &\text{(strain-charge)} \\
    T = c^E S - e^{\mathsf T} E , \quad D = e\,S + \varepsilon^S E \qquad &\text{(stress-charge)}

Poled ceramics have the symmetry of class 6mm: five elastic, three piezoelectric and two dielectric constants determine
the matrices.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

import numpy as np

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.facts.materials.catalogue import Material, material as catalogue_material, read_property_file

VACUUM_PERMITTIVITY = 8.8541878128e-12
"""Permittivity of the vacuum, CODATA 2018. [F/m]"""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PiezoCeramic:
    """Complete linear constants of a piezoelectric ceramic poled along axis 3.

    Parameters
    ----------
    material : Material
        Its scalar properties: density, quality factor, loss tangent.
    stiffness_short_circuit : ndarray, shape (6, 6)
        Elastic stiffness at constant field, c^E. [Pa]
    compliance_short_circuit : ndarray, shape (6, 6)
        Elastic compliance at constant field, s^E. [1/Pa]
    stress_constants : ndarray, shape (3, 6)
        Charge density per strain, which is stress per field, e. [C/m2]
    charge_constants : ndarray, shape (3, 6)
        Charge density per stress, which is strain per field, d. [m/V]
    permittivity_clamped : ndarray, shape (3,)
        Principal permittivities at constant strain, eps^S. [F/m]
    permittivity_free : ndarray, shape (3,)
        Principal permittivities at constant stress, eps^T. [F/m]
    source : str
        Source of the constants; empty for a user-defined ceramic.
    note : str
        Further remarks on the set.

    Notes
    -----
    Constructed by `piezo_ceramic`, `piezo_ceramic_from_strain_charge` or `piezo_ceramic_from_stress_charge`, which make
    both forms consistent. The arrays are read-only.
    """

    material: Material
    stiffness_short_circuit: Floats
    compliance_short_circuit: Floats
    stress_constants: Floats
    charge_constants: Floats
    permittivity_clamped: Floats
    permittivity_free: Floats
    source: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if not (np.all(self.permittivity_clamped > 0) and np.all(np.linalg.eigvalsh(self.stiffness_short_circuit) > 0)):
            raise InvalidInput(
                f"the constants of {self.material.name} do not give a positive stored energy: stiffness and clamped "
                "permittivity must be positive definite; check signs, and whether d or e, free or clamped permittivity "
                "was given"
            )
        for array in (value for field in fields(self) if isinstance(value := getattr(self, field.name), np.ndarray)):
            array.setflags(write=False)


def piezo_ceramic_from_strain_charge(
    *,
    material: Material,
    elastic: Mapping[str, float],
    piezoelectric: Mapping[str, float],
    relative_permittivity: Mapping[str, float],
    source: str = "",
    note: str = "",
) -> PiezoCeramic:
    r"""Piezoelectric ceramic from its constants in strain-charge form.

    Parameters
    ----------
    material : Material
        Its scalar properties.
    elastic : mapping of str to float
        Compliances at constant field by index, "11", "12", "13", "33" and "44", in 1/Pa.
    piezoelectric : mapping of str to float
        Charge constants d by index, "31", "33" and "15", in m/V.
    relative_permittivity : mapping of str to float
        Relative permittivities at constant stress by index, "11" and "33". []
    source, note : str
        Source of the constants, and further remarks on them.

    Returns
    -------
    PiezoCeramic

    Raises
    ------
    InvalidInput
        If a constant is missing, or the stored energy is not positive definite.

    See Also
    --------
    piezo_ceramic_from_stress_charge

    Notes
    -----
    .. math:: c^E = (s^E)^{-1} , \quad e = d\,c^E , \quad \varepsilon^S = \varepsilon^T - d\,e^{\mathsf T}

    References
    ----------
    .. [1] ANSI/IEEE Std 176-1987, IEEE Standard on Piezoelectricity. doi:10.1109/IEEESTD.1988.79638
    """
    s11, s12, s13, s33, s44 = _constants("elastic", elastic, "11", "12", "13", "33", "44")
    s = _elastic_matrix(s11, s12, s13, s33, s44, 2 * (s11 - s12))
    d = _piezoelectric_matrix(piezoelectric)
    eps_t = _permittivities(relative_permittivity)
    c = _inverse(s)
    e = d @ c
    described = {"material": material, "source": source, "note": note}
    return _ceramic(c, s, e, d, clamped=eps_t - np.diag(d @ e.T), free=eps_t, **described)


def piezo_ceramic_from_stress_charge(
    *,
    material: Material,
    elastic: Mapping[str, float],
    piezoelectric: Mapping[str, float],
    relative_permittivity: Mapping[str, float],
    source: str = "",
    note: str = "",
) -> PiezoCeramic:
    r"""Piezoelectric ceramic from its constants in stress-charge form.

    Parameters
    ----------
    material : Material
        Its scalar properties.
    elastic : mapping of str to float
        Stiffnesses at constant field by index, "11", "12", "13", "33" and "44", in Pa.
    piezoelectric : mapping of str to float
        Stress constants e by index, "31", "33" and "15", in C/m2.
    relative_permittivity : mapping of str to float
        Relative permittivities at constant strain by index, "11" and "33". []
    source, note : str
        Source of the constants, and further remarks on them.

    Returns
    -------
    PiezoCeramic

    Raises
    ------
    InvalidInput
        If a constant is missing, or the stored energy is not positive definite.

    See Also
    --------
    piezo_ceramic_from_strain_charge

    Notes
    -----
    .. math:: s^E = (c^E)^{-1} , \quad d = e\,s^E , \quad \varepsilon^T = \varepsilon^S + d\,e^{\mathsf T}

    References
    ----------
    .. [1] ANSI/IEEE Std 176-1987, IEEE Standard on Piezoelectricity. doi:10.1109/IEEESTD.1988.79638
    """
    c11, c12, c13, c33, c44 = _constants("elastic", elastic, "11", "12", "13", "33", "44")
    c = _elastic_matrix(c11, c12, c13, c33, c44, (c11 - c12) / 2)
    e = _piezoelectric_matrix(piezoelectric)
    eps_s = _permittivities(relative_permittivity)
    s = _inverse(c)
    d = e @ s
    described = {"material": material, "source": source, "note": note}
    return _ceramic(c, s, e, d, clamped=eps_s, free=eps_s + np.diag(d @ e.T), **described)


def _ceramic(
    c: Floats, s: Floats, e: Floats, d: Floats, *, clamped: Floats, free: Floats, **described: Any
) -> PiezoCeramic:
    """Ceramic of its matrices in both forms, with its material, source and note."""
    return PiezoCeramic(
        stiffness_short_circuit=c,
        compliance_short_circuit=s,
        stress_constants=e,
        charge_constants=d,
        permittivity_clamped=clamped,
        permittivity_free=free,
        **described,
    )


_CONSTRUCTORS = {"strain-charge": piezo_ceramic_from_strain_charge, "stress-charge": piezo_ceramic_from_stress_charge}


@cache
def piezo_ceramic(name: str) -> PiezoCeramic:
    """Piezoelectric ceramic of the catalogue with its published complete set of constants.

    Parameters
    ----------
    name : str
        Its name or alias, such as "pzt4".

    Returns
    -------
    PiezoCeramic

    Raises
    ------
    UnknownName
        If no piezoelectric ceramic has this name.
    MissingProperty
        If no complete set of its constants is published; its scalar properties are still available from `material`.

    Examples
    --------
    >>> from sonolube.facts.materials import piezo_ceramic
    >>> piezo_ceramic("pzt4").charge_constants[2, 2].item()  # C/N
    2.89e-10
    """
    entries = read_property_file("piezo.toml")
    try:
        scalars = catalogue_material(name)
        entry = entries[scalars.name]
    except LookupError:
        raise UnknownName.among(entries, kind="piezoelectric ceramic", name=name) from None
    if "constants" not in entry:
        raise MissingProperty(
            f"{scalars.name} has no complete set of constants: {entry['missing_constants']}; "
            f"take one of {', '.join(piezo_ceramic_names())}, or give the ten constants"
        )
    constants = dict(entry["constants"])
    return _CONSTRUCTORS[constants.pop("form")](material=scalars, **constants)


def piezo_ceramic_names() -> tuple[str, ...]:
    """Names of the ceramics with a complete set of constants, in alphabetical order."""
    return tuple(sorted(name for name, entry in read_property_file("piezo.toml").items() if "constants" in entry))


def _constants(kind: str, constants: Mapping[str, float], *indices: str) -> list[float]:
    """Constants in the order of their indices; refuse missing and surplus ones."""
    if set(constants) != set(indices):
        raise InvalidInput(f"{kind} constants must be those of index {', '.join(indices)}, got {', '.join(constants)}")
    return [float(require_finite(**{f"{kind} constant {index}": constants[index]})) for index in indices]


def _elastic_matrix(m11: float, m12: float, m13: float, m33: float, m44: float, m66: float) -> Floats:
    """Elastic matrix of class 6mm from its independent constants."""
    return np.array(
        [
            [m11, m12, m13, 0.0, 0.0, 0.0],
            [m12, m11, m13, 0.0, 0.0, 0.0],
            [m13, m13, m33, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, m44, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, m44, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, m66],
        ]
    )


def _inverse(elastic: Floats) -> Floats:
    """Inverse of an elastic matrix; refuse a singular one."""
    try:
        return np.linalg.inv(elastic).astype(np.float64)
    except np.linalg.LinAlgError:
        raise InvalidInput("the elastic constants make a singular matrix; check them for signs and zeros") from None


def _piezoelectric_matrix(piezoelectric: Mapping[str, float]) -> Floats:
    """Piezoelectric matrix of class 6mm, shape (3, 6), from its independent constants."""
    p31, p33, p15 = _constants("piezoelectric", piezoelectric, "31", "33", "15")
    return np.array([[0.0, 0.0, 0.0, 0.0, p15, 0.0], [0.0, 0.0, 0.0, p15, 0.0, 0.0], [p31, p31, p33, 0.0, 0.0, 0.0]])


def _permittivities(relative_permittivity: Mapping[str, float]) -> Floats:
    """Principal permittivities from the relative ones, in F/m."""
    eps11, eps33 = _constants("relative_permittivity", relative_permittivity, "11", "33")
    return VACUUM_PERMITTIVITY * np.array([eps11, eps11, eps33])
