"""A stack of poled layers as one poled block: its stiffness, stroke and capacitance without its layers.

A layer is far thinner than the waves in it, so that n layers of field n V/L each act as one block in the field V/L with
stress constants n times and permittivities n^2 times as large: driven by the stack's own voltage it takes the stack's
own charge and exerts its force.
"""

from dataclasses import replace

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.medium import Medium
from sonolube.materials import Material, PiezoCeramic, piezo_ceramic_from_strain_charge


def homogenised_stack(medium: Medium, *, stack_layers: float) -> Medium:
    """Return a poled medium as a stack of many layers in parallel, for electrodes at its two ends only.

    Parameters
    ----------
    medium : Medium
        Of one layer.
    stack_layers : float
        Number of layers between the two electrodes. []

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If the medium is not piezoelectric or the number not positive.
    """
    n = float(require_positive(stack_layers=stack_layers))
    if medium.stress_constants is None or medium.permittivity is None:
        raise InvalidInput("only a poled medium can be layered: it has neither stress_constants nor permittivity")
    return replace(medium, stress_constants=n * medium.stress_constants, permittivity=n**2 * medium.permittivity)


def stack_ceramic(
    material: Material, *, youngs_modulus: float, charge_constant_15: float, shear_modulus: float
) -> PiezoCeramic:
    """Return the ceramic of a stack from what its maker prints, softened along the poling by the joints of its layers.

    Parameters
    ----------
    material : Material
        Compliances s11 and s33, charge constants d31 and d33, permittivities and Poisson's ratio of the ceramic.
    youngs_modulus : float
        Stiffness of the stack times length over cross section, joints included. [Pa]
    charge_constant_15 : float
        Shear charge constant, which makers seldom print. [m/V]
    shear_modulus : float
        Modulus for shear along the poling at constant field, likewise. [Pa]

    Returns
    -------
    PiezoCeramic

    Raises
    ------
    InvalidInput
        If the stack would be stiffer than its ceramic.
    MissingProperty
        If the material lacks one of the constants named.

    Notes
    -----
    The joints give way along the axis and in shear, as layers of the same Poisson's ratio in series would.
    """
    require_positive(youngs_modulus=youngs_modulus, charge_constant_15=charge_constant_15, shear_modulus=shear_modulus)
    s11, s33, nu = (material.value(name) for name in ("compliance_11", "compliance_33", "poisson_ratio"))
    joints = 1 / youngs_modulus - s33
    if joints < 0:
        raise InvalidInput(f"youngs_modulus of the stack must not exceed its ceramic's, {1 / s33:.4g} Pa")
    return piezo_ceramic_from_strain_charge(
        material=material,
        elastic={
            "11": s11,
            "12": -nu * s11,
            "13": -nu * s33,
            "33": s33 + joints,
            "44": 1 / shear_modulus + 2 * (1 + nu) * joints,
        },
        piezoelectric={
            "31": material.value("charge_constant_31"),
            "33": material.value("charge_constant_33"),
            "15": charge_constant_15,
        },
        relative_permittivity={
            "11": material.value("relative_permittivity_11"),
            "33": material.value("relative_permittivity_33"),
        },
        source="completed from its maker's scalars",
    )
