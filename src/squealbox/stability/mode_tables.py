"""The table of a finite-element brake's modes that an engineer pastes: conventions of codes, who feeds, who moves.

feed-in of a group = (circulation + slope - across) / (2 E) [1/s], summed over its contacts; with damping they add up
                     to the growth rate
share of a component = its part of the kinetic energy u^H M u
MAC to real mode j  = |phi_j' M u|^2 / ((phi_j' M phi_j) (u^H M u)), phi_j undamped and without friction (mu = 0)
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from squealbox.fe import MeshedBrake, pencil_of, real_modes
from squealbox.stability.conventions import as_printed_by
from squealbox.stability.energy import contact_groups, mode_energy
from squealbox.stability.modes_in_band import BandModes
from squealbox.system import DesignOrSystem, as_system

ABOVE = 1.1  # times the band's end up to which uncoupled modes are looked for


def mode_table(design_or_system: DesignOrSystem, modes: BandModes, time: float = 0.0) -> dict[str, Any]:
    """Columns of equal length, a row for each mode of the band with Im > 0, by their name with unit.

    Parameters
    ----------
    design_or_system : what `modes` are of
    modes : as `complex_modes(design, band=...)` returns them
    time : instant of schedules [s]
    """
    half = len(modes.eigenvalues) // 2
    values, shapes = modes.eigenvalues[:half], modes.right[:, :half]
    system = as_system(design_or_system, linear=True)
    moved = system.M @ shapes
    size = np.real(np.einsum("ij,ij->j", shapes.conj(), moved))
    table: dict[str, Any] = {
        "mode": np.arange(1, half + 1),
        "frequency [Hz]": modes.frequency[:half],
        "growth rate [1/s]": modes.growth_rate[:half],
        "error [1/s]": modes.error[:half],
        "damping ratio [-]": modes.damping_ratio[:half],
        "Abaqus damping ratio [-]": as_printed_by("abaqus", values)["damping_ratio"],
        "Ansys stability [Hz]": as_printed_by("ansys", values)["stability"],
        "Nastran damping [-]": as_printed_by("nastran", values)["damping"],
    }
    for name, part in _kinetic(design_or_system, shapes, moved).items():
        table[f"share of {name} [-]"] = part / size
    groups = contact_groups(system.contacts.names)
    fed = np.zeros((half, len(groups)))
    for i in range(half):
        energy = mode_energy(system, modes.mode(i), time)
        each = (energy.circulation + energy.slope - energy.across) / (2.0 * energy.total)
        fed[i] = [float(np.sum(each[rows])) for rows in groups.values()]
    table |= {f"feed-in of {name} [1/s]": fed[:, j] for j, name in enumerate(groups)}
    pencil = pencil_of(system, time)
    bare = real_modes(pencil.elastic, pencil.M, ABOVE * modes.band[1])
    for which in (1, 2):
        table[f"MAC {which} [-]"], table[f"of mode at mu = 0 {which} [Hz]"] = np.zeros(half), np.full(half, np.nan)
    if half and len(bare.frequency):
        likeness = np.abs(bare.shapes.T @ moved) ** 2 / size
        for which in range(min(2, len(bare.frequency))):
            best = np.argsort(-likeness, axis=0)[which]
            table[f"MAC {which + 1} [-]"] = likeness[best, np.arange(half)]
            table[f"of mode at mu = 0 {which + 1} [Hz]"] = bare.frequency[best]
    return table


def _kinetic(design: DesignOrSystem, shapes: np.ndarray, moved: np.ndarray) -> dict[str, Any]:
    """Kinetic energy u^H M u of each component in each shape (n, k), with M u of the whole known, (k,) each."""
    if isinstance(design, MeshedBrake):
        masses = {name: mass @ shapes for name, (mass, _) in design.components().items() if mass.nnz}
        return {name: np.real(np.einsum("ij,ij->j", shapes.conj(), each)) for name, each in masses.items()}
    parts = components(design).items()
    return {name: np.real(np.einsum("ij,ij->j", shapes[rows].conj(), moved[rows])) for name, rows in parts}


def components(design: DesignOrSystem) -> Mapping[str, Any]:
    """Rows of each component that the nodes of an assembled brake name; empty where they name none."""
    structure = design.exported() if hasattr(design, "exported") else None
    if structure is None or structure.nodes is None or structure.labels is None:
        return {}
    of = dict(zip(structure.nodes.numbers.tolist(), structure.nodes.components, strict=False))
    names = np.array([of.get(int(node), "") for node in structure.labels[:, 0]])
    return {str(name): np.flatnonzero(names == name) for name in sorted(set(names.tolist()) - {""})}


def table_text(table: Mapping[str, Any]) -> str:
    """Who moves, who feeds and which uncoupled modes came together, of the modes that grow; one line each."""
    lines = []
    for i in np.flatnonzero(table["growth rate [1/s]"] > table["error [1/s]"]):
        moving = ", ".join(f"{name[9:-4]} {100 * table[name][i]:.0f} %" for name in table if name.startswith("share"))
        feeding = ", ".join(f"{name[11:-6]} {table[name][i]:+.4g}" for name in table if name.startswith("feed-in"))
        mac = " and ".join(
            f"{table[f'MAC {k} [-]'][i]:.2f} to {table[f'of mode at mu = 0 {k} [Hz]'][i]:.6g} Hz" for k in (1, 2)
        )
        printed = (
            f"Abaqus damping ratio {table['Abaqus damping ratio [-]'][i]:+.4g}, "
            f"Ansys stability {table['Ansys stability [Hz]'][i]:+.4g} Hz"
        )
        lines.append(f"mode {int(table['mode'][i])}, {table['frequency [Hz]'][i]:.6g} Hz: {printed}")
        lines += [f"  moves: {moving}"] * bool(moving) + [f"  fed by [1/s]: {feeding}"] * bool(feeding)
        lines.append(f"  MAC to the modes without friction: {mac}")
    return "\n".join(lines)
