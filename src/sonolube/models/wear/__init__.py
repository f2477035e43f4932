"""Wear: Archard's law, the cube model with and without vibration, and the wear mechanism of a material pair."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
