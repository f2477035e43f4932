"""A first rig from what people know: materials, shape of the pin, load, speed, vibration and finish; TOML text.

What nobody has measured yet, such as dry friction and roughness, stands as a distribution with its reason.
"""

from typing import Final

_STATED_AMPLITUDE_FACTOR: Final = 1.15
_DATA_SHEET_FACTOR: Final = 1.33
_SCAN_FACTOR: Final = 1.1
_SCANNED_SUMMITS_FACTOR: Final = 1.5
_MEASURED_FRICTION: Final = "normal 5 %"
_LARGEST_AMPLITUDE: Final = 1e-3
