from .driven_vibration import vibration as vibration
from .gauge_calibration import calibration as calibration
from .hall_rotation import rotation as rotation
from .impedance_fit import impedance as impedance
from .recorded_friction import friction as friction
from .resonance_stiffness import stiffness as stiffness
from .scanned_surface import surface as surface
from .worn_groove import groove as groove
