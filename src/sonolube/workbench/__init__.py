"""Workbench: the main tasks as functions from a rig or a file to a labelled result, and its figure."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
