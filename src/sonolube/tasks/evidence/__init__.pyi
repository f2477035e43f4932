from .learned_posterior import learn as learn
from .published_tests import check as check, list as list, plot as plot
