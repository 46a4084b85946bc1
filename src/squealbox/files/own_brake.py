"""The name of former versions for a place in `designs`."""

from squealbox.designs import OwnBrake, OwnContact, Part

__all__ = ["OwnBrake", "OwnContact", "Part"]
