"""The name of former versions for a place in `friction`."""

from squealbox.friction import OwnLaw, allow, law_from_file, own_law

__all__ = ["OwnLaw", "allow", "law_from_file", "own_law"]
