"""Design of experiments and devices: parameter sweeps, maps, uncertainty propagation and Sobol indices of a rig."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
