"""Plant and friction controller of a rig as co-simulation units of the Functional Mock-up Interface (FMI 2.0, 3.0)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
