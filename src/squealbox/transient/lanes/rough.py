"""Logarithm and exponential to a few per cent, in a handful of operations: for the factors by which steps grow."""

from squealbox.transient.lanes.vectors import BUILDER, Lanes, number, packed_type, wide_type

ONE = float(1023 << 52)  # the bits of 1.0 as a whole number


def rough_log(x: Lanes) -> Lanes:
    """A multiple of the logarithm of x > 0 to a few hundredths of an octave: by its exponent and mantissa."""
    builder = BUILDER.get()
    whole = builder.sitofp(builder.bitcast(x.vector, wide_type()), packed_type())
    return Lanes(builder.fsub(whole, number(ONE)))


def rough_exp(x: Lanes) -> Lanes:
    """What has such a logarithm, to a few per cent: for step factors."""
    builder = BUILDER.get()
    return Lanes(builder.bitcast(builder.fptosi(builder.fadd(x.vector, number(ONE)), wide_type()), packed_type()))
