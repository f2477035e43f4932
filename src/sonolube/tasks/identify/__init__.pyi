from .decay_length_of_run import decay_length as decay_length
from .rig_of_facts import rig as rig
