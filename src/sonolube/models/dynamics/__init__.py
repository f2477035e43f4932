"""Dynamics of a structure vibrating against its contact: steady states, transients, stability, friction averages."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
