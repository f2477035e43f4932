"""sonolube: an open workbench for ultrasonic lubrication.

`import sonolube as sl` offers every task under the name of its command, each loaded when it is first used: a rig from a
file (`sl.read_rig`) or from what is known (`sl.new`), the effect of vibration on it (`sl.predict`, `sl.friction`,
`sl.simulate`, `sl.sweep`), instrument files (`sl.measure.friction`), horns (`sl.horn.design`), the laboratory
(`sl.lab.run`). Each returns an answer that prints as the command does; `sl.plot` draws it. The rooms, such as
`sonolube.models.contact` or `sonolube.facts.materials`, hold the models and facts themselves.
"""

from typing import Any

import lazy_loader as _lazy_loader

from sonolube.former_names import former_name as _former_name, refuse_former_modules as _refuse_former_modules

__version__ = "0.1.0"

_loaded, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)
_refuse_former_modules()


def __getattr__(name: str) -> Any:
    try:
        return _loaded(name)
    except AttributeError:
        if (former := _former_name(name)) is not None:
            raise AttributeError(former) from None
        raise
