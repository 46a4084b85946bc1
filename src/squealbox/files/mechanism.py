"""The name of former versions for a place in `designs`."""

from squealbox.designs import Body, OwnMechanism, Spring, Touch

__all__ = ["Body", "OwnMechanism", "Spring", "Touch"]
