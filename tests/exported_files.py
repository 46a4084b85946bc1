"""One small model written in every format the readers know, by plain Python, for the tests of the readers.

Three masses in a row between walls, as nodes 11, 7 and 30 moving in direction 1, the last also in 2:

    M = diag(1, 2, 3, 3) kg,  K = [[3, -1, 0, 0], [-1, 2, -1, 0], [0, -1, 2, 0.5], [0, 0, 0.5, 4]] 1e6 N/m
"""

import struct
from pathlib import Path

import numpy as np

LABELS = [(7, 1), (11, 1), (30, 1), (30, 2)]
K = np.array([[3.0, -1.0, 0, 0], [-1, 2, -1, 0], [0, -1, 2, 0.5], [0, 0, 0.5, 4]]) * 1e6
M = np.diag([1.0, 2.0, 3.0, 3.0])
FREQUENCIES = np.sqrt(
    np.sort(np.linalg.eigvalsh(np.diag(M.diagonal() ** -0.5) @ K @ np.diag(M.diagonal() ** -0.5)))
) / (2 * np.pi)


def lower(a):
    """Entries (i, j, value), j <= i, that are not zero."""
    return [(i, j, a[i, j]) for i in range(len(a)) for j in range(i + 1) if a[i, j]]


def whole(a):
    """All entries that are not zero."""
    return [(i, j, a[i, j]) for i in range(len(a)) for j in range(len(a)) if a[i, j]]


def coordinate(a):
    """Abaqus COORDINATE."""
    return "".join(f"{i + 1} {j + 1}  {v:.15e}\n" for i, j, v in whole(a))


def matrix_input(a, labels=LABELS, flip=True):
    """Abaqus MATRIX INPUT: one half, and which half changes from line to line."""
    lines = []
    for n, (i, j, v) in enumerate(lower(a)):
        (r, s) = (labels[j], labels[i]) if flip and n % 2 else (labels[i], labels[j])
        lines.append(f"{r[0]},{r[1]}, {s[0]},{s[1]},  {v:.15e}\n")
    return "".join(lines)


def calculix(a):
    """CalculiX: upper half."""
    return "".join(f"{j + 1} {i + 1}  {v:.13e}\n" for i, j, v in lower(a))


def dmig(name, a, labels=LABELS, form=6):
    """Nastran DMIG in wide fields, exponent D."""
    text = f"DMIG    {name:<8}{0:>8}{form:>8}{2:>8}{0:>8}{'':>8}{'':>8}{len(a):>8}\n"
    for j in range(len(a)):
        rows = [i for i in range(len(a) if form == 1 else j + 1) if a[i, j]]
        if rows:
            text += f"DMIG*   {name:<16}{labels[j][0]:>16}{labels[j][1]:>16}\n"
        for i in rows:
            text += f"*       {labels[i][0]:>16}{labels[i][1]:>16}{f'{a[i, j]:.9E}'.replace('E', 'D'):>16}\n"
    return text


def market(a, symmetry="symmetric"):
    """MatrixMarket."""
    entries = lower(a) if symmetry == "symmetric" else whole(a)
    head = f"%%MatrixMarket matrix coordinate real {symmetry}\n% small\n{len(a)} {len(a)} {len(entries)}\n"
    return head + "".join(f"{i + 1} {j + 1} {v:.15e}\n" for i, j, v in entries)


def op4_text(name, a, way="dense"):
    """OP4 as text, type 2: dense, nonbigmat or bigmat."""
    rows = -len(a) if way == "bigmat" else len(a)
    text = f"{len(a):>8}{rows:>8}{6:>8}{2:>8}{name:<8}1P,3E23.16\n"
    for j in range(len(a)):
        nonzero = np.flatnonzero(a[:, j])
        if way == "dense":
            first, values = nonzero[0], a[nonzero[0] : nonzero[-1] + 1, j]
            text += f"{j + 1:>8}{first + 1:>8}{len(values):>8}\n" + numbers(values)
            continue
        size = sum(2 + (2 if way == "bigmat" else 1) for _ in nonzero)
        text += f"{j + 1:>8}{0:>8}{size:>8}\n"
        for i in nonzero:
            text += f"{3:>8}{i + 1:>8}\n" if way == "bigmat" else f"{3 * 65536 + i + 1:>8}\n"
            text += numbers([a[i, j]])
    return text + f"{len(a) + 1:>8}{1:>8}{1:>8}\n" + numbers([1.0])


def numbers(values):
    """Three numbers of width 23 a line."""
    words = [f"{v:>23.16E}" for v in values]
    return "".join("".join(words[i : i + 3]) + "\n" for i in range(0, len(words), 3))


def op4_binary(name, a, way="dense", order="<", word=4):
    """OP4 as Fortran records of either byte order and size of word; doubles."""
    whole_number = "q" if word == 8 else "i"
    per = 8 // word

    def record(data):
        mark = struct.pack(order + "i", len(data))
        return mark + data + mark

    def ints(*values):
        return struct.pack(f"{order}{len(values)}{whole_number}", *values)

    rows = -len(a) if way == "bigmat" else len(a)
    kind = 2 if word == 4 else 1
    raw = record(ints(len(a), rows, 6, kind) + name.ljust(2 * word).encode())
    for j in range(len(a)):
        nonzero = np.flatnonzero(a[:, j])
        if way == "dense":
            values = a[nonzero[0] : nonzero[-1] + 1, j]
            body, first = values.astype(order + "f8").tobytes(), nonzero[0] + 1
        else:
            body, first = b"", 0
            for i in nonzero:
                body += ints(per + 1, i + 1) if way == "bigmat" else ints((per + 1) * 65536 + i + 1)
                body += struct.pack(order + "d", a[i, j])
        raw += record(ints(j + 1, int(first), len(body) // word) + body)
    return raw + record(ints(len(a) + 1, 1, per) + struct.pack(order + "d", 1.0))


def full_file(k, m, labels=LABELS, fixed=()):
    """Ansys .full: records in words of 4 bytes, upper half by rows, the diagonal last."""

    def record(values, kind):
        data = np.asarray(values, kind).tobytes()
        mark = struct.pack("<i", len(data) // 4)
        return mark + struct.pack("<I", 0x80000000 if kind == "<i4" else 0) + data + mark

    def matrix(a):
        raw = b""
        for i in range(len(a)):
            columns = [j for j in range(i + 1, len(a)) if a[i, j]] + [i]
            raw += record([j + 1 for j in columns], "<i4") + record([a[i, j] for j in columns], "<f8")
        return raw

    nodes = sorted({node for node, _ in labels}, key=[node for node, _ in labels].index)
    counts = [sum(1 for node, _ in labels if node == n) for n in nodes]
    marks = [-d if (n, d) in fixed else d for n, d in labels]
    first = record(np.zeros(100), "<i4")
    before = record([1, 2, 3], "<i4") + record(nodes, "<i4")
    head = np.zeros(160, int)
    stiff, mass = matrix(k), matrix(m)
    at = len(first) // 4 + 163 + len(before) // 4
    head[[0, 1, 8, 18, 26, 32, 33]] = -4, len(k), len(lower(k)), at, at + len(stiff) // 4, len(nodes), len(lower(m))
    head[35] = at + (len(stiff) + len(mass)) // 4
    raw = first + record(head, "<i4") + before + stiff + mass + record(counts, "<i4") + record(marks, "<i4")
    return b"\x64\x00\x00\x00\x00\x00\x00\x80" + raw[8:]


def substructure(k, m, nodes=(7, 11, 30), unsymmetric=False):
    """Abaqus substructure of nodes with one freedom each: four numbers a line, rows wrapped."""

    def block(a):
        text = ""
        for i in range(len(a)):
            row = a[i] if unsymmetric else a[i, : i + 1]
            words = [f"{v:.14g}" for v in row]
            lines = [", ".join(words[n : n + 4]) for n in range(0, len(words), 4)]
            text += ",\n".join(lines) + "\n"
        return text

    head = f"**\n** GENERATION OF SUBSTRUCTURE Z1\n*USER ELEMENT, NODES=  {len(nodes)}, LINEAR"
    head += ", UNSYM\n" if unsymmetric else "\n"
    head += "** ELEMENT NODES\n** " + ", ".join(map(str, nodes)) + "\n 1\n"
    return head + "*MATRIX,TYPE=STIFFNESS\n" + block(k) + "*MATRIX,TYPE=MASS\n" + block(m)


def optistruct(k, m, labels=LABELS):
    """OptiStruct .full.mat as its public description says."""

    def block(name, a, kind, form):
        text = f"{name} 0 {kind} 1 {a.shape[1]} {a.shape[0]} {form}\n"
        for j in range(a.shape[1]):
            text += f"{j + 1} 1 {a.shape[0]}\n" + " ".join(f"{v:.15g}" for v in a[:, j]) + "\n"
        return text

    return block("STIFFNESS", k, 2, "5E16.9") + block("MASS", m, 2, "5E16.9") + block("DOFS", np.array(labels), 1, "I8")


def write(folder: Path, name: str, content) -> Path:
    """The file, written."""
    path = folder / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content)
    return path
