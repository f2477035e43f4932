"""Factors of the units that users write most, so that reading a rig need not wait for a registry of units."""

COMMON_FACTORS: dict[str, dict[str, float]] = {
    "": {"": 1.0, "%": 0.01},
    "N": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3, "lbf": 4.4482216152605005},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "in": 0.0254},
    "m2": {"m2": 1.0, "cm2": 1e-4, "mm2": 1e-6, "um2": 1e-12, "m^2": 1.0, "mm^2": 1e-6, "um^2": 1e-12, "mm3/m": 1e-9},
    "m3": {"m3": 1.0, "mm3": 1e-9},
    "1/m2": {"1/m2": 1.0, "/m2": 1.0, "1/mm2": 1e6, "/mm2": 1e6},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "kgf/mm2": 9806650.0},
    "V": {"V": 1.0, "mV": 1e-3, "kV": 1e3},
    "Hz": {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "um/s": 1e-6},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0},
    "F": {"F": 1.0, "uF": 1e-6, "nF": 1e-9, "pF": 1e-12},
    "N/m": {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "N/mm": 1e3, "N/um": 1e6},
    "m/V": {"m/V": 1.0, "um/V": 1e-6, "nm/V": 1e-9},
    "N s/m": {"N s/m": 1.0, "N*s/m": 1.0},
    "kg": {"kg": 1.0, "g": 1e-3, "mg": 1e-6},
    "W": {"W": 1.0, "mW": 1e-3, "kW": 1e3},
    "K": {"K": 1.0},
    "1/s": {"1/s": 1.0, "1/min": 1 / 60},
    "m2/N": {"m2/N": 1.0, "mm3/(N m)": 1e-9, "mW mm2/(N W)": 1e-9},
    "m s/N": {"m s/N": 1.0, "mW mm2 s/(N W m)": 1e-9},
    "kg/m3": {"kg/m3": 1.0},
}
"""SI value of one of a unit, by the SI unit and the unit as written; those of pint, to the last bit."""

CELSIUS_ORIGIN = 273.15
"""Temperature of 0 degC. [K]"""
