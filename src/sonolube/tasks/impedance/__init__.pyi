from .computed_impedance import compute as compute
