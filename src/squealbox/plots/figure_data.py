"""The name of former versions for `squealbox.figure_data`."""

import sys

from squealbox import figure_data

sys.modules[__name__] = figure_data
