"""Logarithm and exponential to a few per cent, in a handful of operations: for the factors by which steps grow."""

from squealbox.compiled import Lanes, as_reals, as_whole, number, put, reals, wide

ONE = float(1023 << 52)  # the bits of 1.0 as a whole number


def rough_log(x: Lanes) -> Lanes:
    """A multiple of the logarithm of x > 0 to a few hundredths of an octave: by its exponent and mantissa."""
    whole = put(f"sitofp {wide()} {as_whole(x.vector)} to {reals()}")
    return Lanes(put(f"fsub {reals()} {whole}, {number(ONE)}"))


def rough_exp(x: Lanes) -> Lanes:
    """What has such a logarithm, to a few per cent: for step factors."""
    moved = put(f"fadd {reals()} {x.vector}, {number(ONE)}")
    return Lanes(as_reals(put(f"fptosi {reals()} {moved} to {wide()}")))
