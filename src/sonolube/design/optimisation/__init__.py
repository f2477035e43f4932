"""Optimisation of a rig: actuator, frequency, waveform and structure for a target friction at minimum power or heat."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
