"""Friction control: controllers of the friction force, tuned for a rig, simulated in closed loop and exported as C."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
