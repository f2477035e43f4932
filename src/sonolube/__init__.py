"""sonolube: an open workbench for ultrasonic lubrication.

`import sonolube as sl` offers every task under the name of its command, each loaded when it is first used: a rig from a
file (`sl.read_rig`) or from what is known (`sl.new`), the effect of vibration on it (`sl.predict`, `sl.friction`,
`sl.simulate`, `sl.sweep`), instrument files (`sl.measure.friction`), horns (`sl.horn.design`), the laboratory
(`sl.lab.run`). Each returns an answer that prints as the command does; `sl.plot` draws it. The rooms, such as
`sonolube.models.contact` or `sonolube.facts.materials`, hold the models and facts themselves.
"""

import lazy_loader as _lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)
