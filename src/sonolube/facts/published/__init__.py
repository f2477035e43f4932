"""Published data of the dissertation: tables, quoted numbers, figure captions, reviewed studies and errata.

D is "Friction and Wear Reduction via Ultrasonic Lubrication", the dissertation that sonolube implements. Numbers are
kept with their printed digits, so that their rounding intervals are known; errata stand beside them as corrections.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
