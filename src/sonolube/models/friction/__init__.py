"""Friction laws, friction under vibration, and friction models of vibrated rough contacts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
