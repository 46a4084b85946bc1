"""A small finite-element brake as another code would export it, with closed forms to hold it against: two blocks that
press on each other, nodes 1 (slave, below) and 2 (master), each with three displacements held by springs and dashpots.
"""

import numpy as np

import exported_files as made

LABELS = [(1, 1), (1, 2), (1, 3), (2, 1), (2, 2), (2, 3)]
MASS = np.diag([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # kg
SPRINGS = np.diag([4.0e6, 3.0e6, 5.0e6, 8.0e6, 7.0e6, 9.0e6])  # N/m
SPRINGS[0, 1] = SPRINGS[1, 0] = -1.0e6
PAIRS = "slave, master, nx, ny, nz, area\n1, 2, 0, 0, 1, 2e-3\n"
NODES = "node, x, y, z\n1, 0.1, 0, 0\n2, 0.1, 0, 0.01\n"


def write_export(folder, pairs=PAIRS, units=1.0):
    """The files of the export."""
    made.write(folder, "b_MASS1.mtx", made.matrix_input(MASS, LABELS))
    made.write(folder, "b_STIF1.mtx", made.matrix_input(SPRINGS, LABELS))
    made.write(folder, "pad.csv", pairs)
    made.write(folder, "nodes.csv", NODES)
    return folder


DESIGN = """\
brake = "assembled"
angular_speed = "20 rad/s"
friction = { law = "coulomb", static = 0.5 }
beta = "1e-6 s"

[structure]
units = "SI"
mass = "b_MASS1.mtx"
stiffness = "b_STIF1.mtx"
nodes = "nodes.csv"

[[interfaces]]
name = "pad"
pairs = "pad.csv"
stiffness = "1e9 N/m^3"
pressure = "50 kPa"
sliding = { axis = [0, 0, 1] }

[modes]
band = ["10 Hz", "2 kHz"]
"""
