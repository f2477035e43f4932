"""Effective material of a multilayer piezoelectric stack: homogenised layers, and a ceramic softened by its joints."""

from dataclasses import replace

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.materials import Material, PiezoCeramic, piezo_ceramic_from_strain_charge
from sonolube.models.fem.solver.model import Medium


def homogenised_stack(medium: Medium, *, stack_layers: float) -> Medium:
    r"""Homogenised medium of a stack of thin layers in parallel, for electrodes at its two ends only.

    Parameters
    ----------
    medium : Medium
        Poled medium of one layer.
    stack_layers : float
        Number of layers between the two electrodes. []

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If the medium is not piezoelectric or the number not positive.

    Notes
    -----
    Layers much thinner than the acoustic wavelength hold the field at n V/L in a stack of n layers and length L. A
    block in the field V/L has the same force and charge at the voltage V with

    .. math:: e_\mathrm{eff} = n\, e, \qquad \varepsilon^S_\mathrm{eff} = n^2 \varepsilon^S
    """
    n = float(require_positive(stack_layers=stack_layers))
    if medium.stress_constants is None or medium.permittivity is None:
        raise InvalidInput("only a poled medium can be layered: it has neither stress_constants nor permittivity")
    return replace(medium, stress_constants=n * medium.stress_constants, permittivity=n**2 * medium.permittivity)


def stack_ceramic(
    material: Material, *, youngs_modulus: float, charge_constant_15: float, shear_modulus: float
) -> PiezoCeramic:
    r"""Ceramic constants of a stack from data-sheet scalars, with the compliance of the joints between its layers.

    Parameters
    ----------
    material : Material
        Compliances s11 and s33, charge constants d31 and d33, permittivities and Poisson's ratio of the ceramic.
    youngs_modulus : float
        Stiffness of the stack times length over cross-section, joints included. [Pa]
    charge_constant_15 : float
        Shear charge constant, which data sheets seldom list. [m/V]
    shear_modulus : float
        Shear modulus along the poling at constant field, likewise. [Pa]

    Returns
    -------
    PiezoCeramic

    Raises
    ------
    InvalidInput
        If the stack would be stiffer than the ceramic.
    MissingProperty
        If the material lacks one of these constants.

    Notes
    -----
    The compliance of the joints is in series with that of the ceramic, along the poling and in shear, with the same
    Poisson's ratio:

    .. math::

        s_j = \frac{1}{E} - s_{33}^E, \qquad s_{33}' = s_{33}^E + s_j, \qquad
        s_{44}' = \frac{1}{G} + 2 (1 + \nu) s_j, \qquad s_{12} = -\nu s_{11}^E, \qquad s_{13} = -\nu s_{33}^E
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
