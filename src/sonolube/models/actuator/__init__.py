"""Piezoelectric actuators: stacks, their drive and electrical matching, horns and waveguides, and a catalogue."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
