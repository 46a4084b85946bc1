"""A number with a unit: right values, pint as the second opinion on every unit of the table, and odd ones refused."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealbox.units import NAMES, UnitError, in_si, split

GOOD = [
    ("1 kN", "N", 1000.0),
    ("35 deg", "rad", 35.0 * math.pi / 180.0),
    ("35°", "rad", 35.0 * math.pi / 180.0),
    ("-0.05 s/m", "s/m", -0.05),
    ("190 kN/mm", "N/m", 190e6),
    ("218 N s/m", "N s/m", 218.0),
    ("218 N*s/m", "N s/m", 218.0),
    ("218 N·s/m", "N s/m", 218.0),
    ("-4 m/s^2", "m/s^2", -4.0),
    ("-4 m/s**2", "m/s^2", -4.0),
    ("-4 m/s/s", "m/s^2", -4.0),
    ("-4 m s^-2", "m/s^2", -4.0),
    ("-4 m/s²", "m/s^2", -4.0),
    ("+.5mm", "m", 5e-4),
    ("5.", "m", 5.0),
    ("1e-3 m", "m", 1e-3),
    ("1E3 mm", "m", 1.0),
    ("  3   kg  ", "kg", 3.0),
    ("40 %", "-", 0.4),
    ("0.4", "-", 0.4),
    ("0.4 -", "-", 0.4),
    ("0", "m", 0.0),
    ("3000 rpm", "rad/s", 100.0 * math.pi),
    ("2 turn/s", "rad/s", 4.0 * math.pi),
    ("50 1/s", "Hz", 50.0),
    ("2 kHz", "Hz", 2000.0),
    ("36 km/h", "m/s", 10.0),
    ("5 Nm/deg", "N m/rad", 5.0 * 180.0 / math.pi),
    ("5 Nm", "N m/rad", 5.0),
    ("1 lbf/in", "N/m", 0.45359237 * 9.80665 / 0.0254),
    ("7 furlong", "m", 7 * 201.168402),
]


@pytest.mark.parametrize(("text", "expected", "value"), GOOD)
def test_a_quantity_is_converted(text, expected, value):
    # 4 ulp: a product of two or three exact factors. A furlong is of the US survey foot in pint, good to 9 digits.
    assert in_si(text, expected) == pytest.approx(value, rel=1e-8 if "furlong" in text else 1e-15)


def test_common_quantities_are_exact():
    assert in_si("190 kN/mm", "N/m") == 190e6
    assert in_si("50 ms", "s") == 0.05
    assert in_si("0.2 m/s", "m/s") == 0.2


@pytest.fixture(scope="module")
def registry():
    import pint

    return pint.UnitRegistry()


# pint calls these by other names or gives them another meaning (Nm is its number metre).
OTHER_NAMES = {"Nm": "N*m", "°": "deg", "rev": "turn", "%": "percent", "1": ""}


@pytest.mark.parametrize("name", NAMES)
def test_the_table_agrees_with_pint(name, registry):
    prefix, base = (name[:-2], "Nm") if name.endswith("Nm") else ("", name)
    text = f"{prefix}N*m" if base == "Nm" else OTHER_NAMES.get(base, base)
    theirs = registry.Quantity(1.0, text).to_base_units()
    ours = NAMES[name]
    assert ours.factor == pytest.approx(theirs.magnitude, rel=1e-14)
    powers = dict(theirs.unit_items())
    mass, length, time, angle = (powers.get(each, 0) for each in ("kilogram", "meter", "second", "radian"))
    assert ours.dimension == (mass, length, time, angle)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("100 rad/s", "Hz"), ("100 Hz", "rad/s"), ("20 deg", "-"), ("1 rad", "1/s"), ("1 m", "kg"), ("1 s/m", "m/s"),
        ("1 N", "N/m"), ("1 a", "s"), ("1 c", "m/s"), ("1 MM", "m"), ("1 d", "s"), ("1 e", "-"), ("1 dB", "-"),
        ("1 bit", "-"), ("1 count", "-"), ("1 ampere", "N"), ("1 kelvin", "N"),
    ],
)  # fmt: skip
def test_a_look_alike_is_refused(text, expected):
    with pytest.raises(UnitError):
        in_si(text, expected)


def finite_or_refused(text: str, expected: str) -> bool:
    """True when `text` is a finite number, or is refused in one line."""
    try:
        return math.isfinite(in_si(text, expected))
    except UnitError as error:
        return "\n" not in str(error)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_number_is_read_to_the_bit(number):
    if number == 0.0 or abs(number) > 1e-300:
        assert in_si(f"{number!r} kg", "kg") == number


@given(st.text(max_size=60))
def test_any_text_is_a_finite_number_or_an_error(text):
    assert finite_or_refused(text, "N")


@given(st.from_regex(r"[0-9eE+.-]{1,8} ?[A-Za-z0-9*/^ %()-]{0,20}", fullmatch=True))
def test_what_looks_like_a_quantity_is_a_finite_number_or_an_error(text):
    assert finite_or_refused(text, "m/s")


def test_the_number_is_split_off_first():
    assert split("1e5 N") == (1e5, "N")
    assert split("1 eV") == (1.0, "eV")
