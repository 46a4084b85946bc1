"""Quick estimates beside the numerics: one harmonic, averaging, and the exact end of stick-slip of one block.

Depends on: branches, cycles.
"""
