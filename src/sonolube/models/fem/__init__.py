"""Finite elements of linear piezoelectricity: bodies, meshes, natural modes, electromechanical and forced response."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
