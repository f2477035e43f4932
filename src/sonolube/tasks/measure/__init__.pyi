from .recordings import (
    calibration as calibration,
    friction as friction,
    rotation as rotation,
    temperature as temperature,
    vibration as vibration,
)
from .scanned_surface import surface as surface
from .spectra import impedance as impedance, stiffness as stiffness
from .worn_groove import groove as groove
