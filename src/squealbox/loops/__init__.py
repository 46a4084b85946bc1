"""Loops: what senses a brake and acts on it; their rows stand beside those of the contacts."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
