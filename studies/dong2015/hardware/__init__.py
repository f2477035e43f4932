"""Hardware of the dissertation by finite elements: tribometer actuator, cutter head and collar element."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
