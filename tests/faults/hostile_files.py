"""Two hundred design files that are wrong, each with the line, the key and the words of the one sentence it must get.

Most are the first line ``brake = "drum_brake"`` and one faulty line after it, so the line is 2.
"""

# ruff: noqa: E501, RUF001  (rows of a table; characters that look alike are the point)

DRUM = 'brake = "drum_brake"\n'
OWN = 'brake = "own"\nM = [[1, 0], [0, 1]]\nK = [[2, 1], [1, 2]]\n'
CONTACT = OWN + "[[contacts]]\nn = [0, 1]\nd = [1, 0]\n"
LAW = DRUM + "[friction]\n"
RAMP = DRUM + "[sliding_speed.ramp]\n"

Fault = tuple[str | bytes, int, str, str]


def _values() -> dict[str, Fault]:
    """One value that is no number of the right kind."""
    faults = {
        "nan": ("nan", "nan: expected a finite number in (0, inf) kg"),
        "minus nan": ("-nan", "expected a finite number"),
        "infinite": ("inf", "inf: expected a finite number"),
        "minus infinite": ("-inf", "expected a finite number"),
        "overflowing float": ("1e999", "inf: expected"),
        "huge whole number": ("1" + "0" * 400, "a whole number of 1329 bits"),
        "huge hexadecimal": ("0x" + "f" * 300, "a whole number of 1200 bits"),
        "zero where none may be": ("0", "in (0, inf) kg"),
        "negative": ("-1.0", "-1.0: expected"),
        "true": ("true", "true: expected a finite number in (0, inf) kg, such as '1 kg'"),
        "a date": ("1979-05-27", "1979-05-27: expected"),
        "a time": ("07:32:00", "07:32:00: expected"),
        "a list": ("[1, 2]", "[1, 2]: expected"),
        "an empty list": ("[]", "[]: expected"),
        "a table": ("{ value = 1 }", "a table: expected"),
        "an empty table": ("{}", "a table: expected"),
        "a schedule where none may be": ("{ ramp = { start = 1, slope = 1 } }", "a table: expected"),
        "empty text": ('""', "'' is not a number with a unit"),
        "a word": ('"heavy"', "'heavy' is not a number with a unit"),
        "nan as text": ('"nan"', "'nan' is not a number"),
        "nan with a unit": ('"nan kg"', "'nan kg' is not a number"),
        "inf as text": ('"inf kg"', "'inf kg' is not a number"),
        "overflow as text": ('"1e999 kg"', "'1e999 kg' is too large"),
        "overflow by the unit": ('"1e308 kt"', "unknown unit 'kt'"),
        "overflow by conversion": ('"1e307 t"', "'1e307 t' is too large"),
        "underflow as text": ('"1e-999 kg"', "'1e-999 kg' is too small"),
        "huge exponent": ('"1e99999999999999999999 kg"', "too large"),
        "decimal comma": ('"1,5 kg"', "write a decimal point, not a comma"),
        "thousands apart": ('"1 000 kg"', "'1 000 kg' is not a number"),
        "underscore": ('"1_000 kg"', "'1_000 kg' is not a number"),
        "hexadecimal": ('"0x10 kg"', "is not a unit"),
        "fraction": ('"1/2 kg"', "'/2 kg' is not a unit"),
        "two signs": ('"--1 kg"', "'--1 kg' is not a number"),
        "sign apart": ('"- 1 kg"', "'- 1 kg' is not a number"),
        "percent of nothing": ('"5 %"', "expected kg (a mass)"),
        "full-width digits": ('"１ kg"', "is not a number with a unit"),
        "arabic digits": ('"١ kg"', "is not a number with a unit"),
        "roman numeral": ('"Ⅳ kg"', "is not a number with a unit"),
        "superscript number": ('"² kg"', "is not a number with a unit"),
        "line break": ('"1\\nkg"', "is not a number with a unit"),
        "NUL": ('"1\\u0000kg"', "is not a number with a unit"),
        "right to left": ('"1 \\u202ekg"', "is not a number with a unit"),
        "very long text": ('"' + "1" * 5000 + '"', "has 5000 characters"),
        "very long unit": ('"1 ' + "kg " * 2000 + '"', "has 6002 characters"),
    }
    return {f"value, {name}": (f"{DRUM}m = {text}\n", 2, "m", words) for name, (text, words) in faults.items()}


def _units() -> dict[str, Fault]:
    """Units of another dimension, unknown ones, and text that a units library hangs on or misreads."""
    loads = {
        "a mass": ("1 kg", "'1 kg' has the unit kg (a mass), expected N (a force)"),
        "a stiffness": ("1 N/m", "has the unit N/m (a stiffness), expected N (a force)"),
        "a pressure": ("1 MPa", "(a pressure), expected N (a force)"),
        "a moment": ("1 N m", "(a moment or an energy), expected N"),
        "an angle": ("1 deg", "(an angle), expected N (a force)"),
        "a square": ("1 N^2", "has the unit N^2 (kg^2 m^2 s^-4), expected N"),
        "a temperature": ("20 degC", "unknown unit 'degC'"),
        "a current": ("1 A", "unknown unit 'A'"),
        "kilo without a unit": ("1 k", "unknown unit 'k'"),
        "wrong case": ("1 KN", "unknown unit 'KN', did you mean 'kN'?"),
        "wrong case twice": ("1 kn", "did you mean 'kN'?"),
        "not a word": ("1 zorkmids", "unknown unit 'zorkmids'"),
        "a greek look-alike": ("1 kΝ", "the character '\\u039d' has no place"),
        "a mathematical letter": ("1 𝐍", "the character '\\U0001d40d' has no place"),
        "tower of powers": ("9**9**9**9 N", "is not a unit"),
        "tower in the unit": ("1 N**9**9**9", "has the exponent 9"),
        "huge power": ("1 N^999999999", "has the exponent 999999999"),
        "power of seven": ("1 N^7", "has the exponent 7, expected at most 6"),
        "broken power": ("1 N^0.5", "the character '.' has no place"),
        "second statement": ("1 N; 2", "the character ';' has no place"),
        "second number": ("1 N 2", "is not a unit"),
        "number first": ("1 2 N", "is not a number with a unit"),
        "product of numbers": ("2*3 N", "is not a unit"),
        "sum": ("1 N + 1 N", "is not a unit"),
        "call": ("1 __import__('os')", "is not a number with a unit"),
        "call of a unit": ("1 N()", "the character '(' has no place"),
        "attribute": ("1 N.__class__", "the character '.' has no place"),
        "dunder": ("1 __class__", "is not a number with a unit"),
        "format string": ("1 {0}", "is not a number with a unit"),
        "percent format": ("1 %s", "unknown unit '%s'"),
        "comment": ("1 N # 2", "the character '#' has no place"),
        "slash at the end": ("1 N/", "is not a unit"),
        "two slashes": ("1 N//m", "is not a unit"),
        "only a slash": ("1 /", "is not a unit"),
        "nine factors": ("1 N m m m m m m m m", "is not a unit"),
        "one as a factor": ("1 N 1", "is not a unit"),
        "only a one": ("1 1", "is not a unit"),
        "a currency": ("1 €", "is not a number with a unit"),
        "decibel": ("3 decibel", "unknown unit 'decibel'"),
        "a long dimensionless word": ("3 radian radian", "expected N (a force)"),
    }
    faults = {f"unit, {name}": (f'{DRUM}load = "{text}"\n', 2, "load", words) for name, (text, words) in loads.items()}
    slopes = {
        "slope of friction upside down": ("slope", "-0.05 m/s", "(a speed), expected s/m (a slope of friction)"),
        "slope with an angle": ("slope", "-0.05 s/rad", "expected s/m"),
        "angle for a coefficient": ("static", "20 deg", "(an angle), expected a plain number without a unit"),
        "force for a coefficient": ("static", "0.3 N", "(a force), expected a plain number without a unit"),
    }
    for name, (key, text, words) in slopes.items():
        other = "slope = 0" if key == "static" else "static = 0.3"
        body = f'{LAW}law = "linear_slope"\n{key} = "{text}"\n{other}\n'
        faults[f"unit, {name}"] = (body, 4, f"friction.{key}", words)
    faults["unit, angle in newtons"] = (f'{DRUM}theta1 = "35 N"\n', 2, "theta1", "expected rad (an angle)")
    faults["unit, angle beyond its range"] = (f'{DRUM}theta1 = "350 deg"\n', 2, "theta1", "[-3.14159, 3.14159] rad")
    faults["unit, speed as revolutions"] = (
        f'{DRUM}sliding_speed = "300 rpm"\n', 2, "sliding_speed", "(an angular frequency), expected m/s (a speed)"
    )  # fmt: skip
    faults["unit, circular frequency for hertz"] = (
        f'{DRUM}sliding_speed = {{ sinusoid = {{ mean = 1, amplitude = 1, frequency = "9 rad/s" }} }}\n',
        2, "sliding_speed.sinusoid.frequency", "(an angular frequency), expected Hz (a frequency)",
    )  # fmt: skip
    return faults


def _keys() -> dict[str, Fault]:
    """Keys that do not exist, are missing, or say the same thing twice."""
    return {
        "key, misspelt": (f"{DRUM}thetta1 = 1\n", 2, "thetta1", "unknown key, did you mean 'theta1'? one of m, c1"),
        "key, of another brake": (f"{DRUM}M = [[1]]\n", 2, "M", "unknown key"),
        "key, quoted": (f'{DRUM}"a b" = 1\n', 2, "'a b'", "unknown key"),
        "key, empty": (f'{DRUM}"" = 1\n', 2, "''", "unknown key"),
        "key, very long": (f"{DRUM}{'x' * 90000} = 1\n", 2, "x" * 30 + "...", "unknown key"),
        "key, unicode": (f'{DRUM}"µ" = 1\n', 2, r"'\xb5'", "unknown key"),
        "key, line break": (f'{DRUM}"a\\nb" = 1\n', 2, r"'a\nb'", "unknown key"),
        "key, dunder": (f"{DRUM}__class__ = 1\n", 2, "__class__", "unknown key"),
        "key, a method": (f"{DRUM}system = 1\n", 2, "system", "unknown key"),
        "key, deep": (f"{DRUM}friction.a.b.c = 1\n", 2, "friction", "the key 'law' is missing"),
        "key, alias and part": (f"{DRUM}load = 1\nload1 = 2\n", 3, "load1", "give one of the two"),
        "key, part and alias": (f"{DRUM}load2 = 1\nload = 2\n", 3, "load", "sets load2"),
        "key, brake missing": ("m = 1\n", 1, "", "the key 'brake' is missing, expected one of drum_brake"),
        "key, empty file": ("", 1, "", "the key 'brake' is missing"),
        "key, only a comment": ("# nothing\n", 1, "", "the key 'brake' is missing"),
        "key, brake unknown": ('brake = "drum_break"\n', 1, "brake", "did you mean 'drum_brake'?"),
        "key, brake a number": ("brake = 3\n", 1, "brake", "3: expected one of drum_brake"),
        "key, brake a list": ('brake = ["drum_brake"]\n', 1, "brake", "expected one of"),
        "key, brake a class": ('brake = "__init__"\n', 1, "brake", "unknown name '__init__'"),
        "key, reading unknown": (f'{DRUM}reading = "eq4"\n', 2, "reading", "unknown name 'eq4', did you mean 'eq3'?"),
        "key, reading a number": (f"{DRUM}reading = 3\n", 2, "reading", "3: expected one of eq1_printed"),
        "law, a number": (f"{DRUM}friction = 0.4\n", 2, "friction", "{ law = 'coulomb', static = 0.4 }"),
        "law, a word": (f'{DRUM}friction = "coulomb"\n', 2, "friction", "expected a table such as"),
        "law, unnamed": (f"{DRUM}friction = {{ static = 0.4 }}\n", 2, "friction", "the key 'law' is missing"),
        "law, unknown": (f'{LAW}law = "coulom"\n', 3, "friction.law", "did you mean 'coulomb'?"),
        "law, a kind": (f'{LAW}law = "friction.Coulomb"\n', 3, "friction.law", "unknown name"),
        "law, static missing": (f'{LAW}law = "coulomb"\n', 2, "friction", "the key 'static' is missing"),
        "law, of another law": (f'{LAW}law = "coulomb"\nstatic = 1\ndelta = 2\n', 5, "friction.delta", "unknown key"),
        "law, formula": (f'{LAW}law = "coulomb"\nstatic = 1\nformula = 2\n', 5, "friction.formula", "unknown key"),
        "law, kinetic above static": (
            f'{LAW}law = "coulomb"\nstatic = 0.3\nkinetic = 0.4\n', 5, "friction.kinetic", "at most static = 0.3"
        ),
        "law, negative": (f'{LAW}law = "coulomb"\nstatic = -0.3\n', 4, "friction.static", "in [0, 10]"),
        "law, speed of zero": (
            f'{LAW}law = "stribeck"\nstatic = 1\nkinetic = 1\nspeed = 0\n', 6, "friction.speed", "in (0, inf) m/s"
        ),
        "law, table not increasing": (
            f'{LAW}law = "table"\nspeeds = [1, 0]\nvalues = [1, 1]\n', 4, "friction.speeds", "two or more increasing"
        ),
        "law, table of one": (f'{LAW}law = "table"\nspeeds = [1]\nvalues = [1]\n', 4, "friction.speeds", "two or more"),
        "law, table of two lengths": (
            f'{LAW}law = "table"\nspeeds = [0, 1]\nvalues = [1]\n', 5, "friction.values", "2 coefficients"
        ),
        "law, table with a wrong unit": (
            f'{LAW}law = "table"\nspeeds = [0, "1 m"]\nvalues = [1, 1]\n', 4, "friction.speeds[1]", "expected m/s"
        ),
        "law, table nested": (
            f'{LAW}law = "table"\nspeeds = [0, [1]]\nvalues = [1, 1]\n', 4, "friction.speeds[1]", "[1]: expected"
        ),
        "schedule, unknown": (f"{DRUM}load = {{ step = {{ a = 1 }} }}\n", 2, "load.step", "unknown schedule"),
        "schedule, two": (f"{DRUM}load = {{ constant = {{}}, ramp = {{}} }}\n", 2, "load", "a schedule such as"),
        "schedule, empty": (f"{DRUM}load = {{}}\n", 2, "load", "a schedule such as"),
        "schedule, a number": (f"{DRUM}load = {{ ramp = 3 }}\n", 2, "load", "a schedule such as"),
        "schedule, slope missing": (f"{RAMP}start = 1\n", 2, "sliding_speed.ramp", "the key 'slope' is missing"),
        "schedule, slope a speed": (
            f'{RAMP}start = 1\nslope = "4 m/s"\n', 4, "sliding_speed.ramp.slope", "expected m/s^2 (an acceleration)"
        ),
        "schedule, begin a length": (
            f'{RAMP}start = 1\nslope = 4\nbegin = "1 m"\n', 5, "sliding_speed.ramp.begin", "expected s (a time)"
        ),
        "schedule, in a schedule": (
            f"{RAMP}slope = 4\nstart = {{ constant = {{ level = 1 }} }}\n", 4, "sliding_speed.ramp.start", "a table"
        ),
    }  # fmt: skip


def _sections() -> dict[str, Fault]:
    """What is asked of the brake, asked wrongly."""
    simulate, axis = f"{DRUM}[simulate]\n", f"{DRUM}[onset]\n"
    return {
        "section, misspelt": (f"{DRUM}[simulat]\n", 2, "simulat", "did you mean 'simulate'?"),
        "section, a number": (f"{DRUM}simulate = 1\n", 2, "simulate", "expected a section [simulate]"),
        "section, several": (f"{DRUM}[[simulate]]\n", 2, "simulate", "expected a section [simulate]"),
        "modes, unknown key": (f"{DRUM}[modes]\ncount = 3\n", 3, "modes.count", "unknown key, one of time"),
        "simulate, duration of zero": (f"{simulate}duration = 0\n", 3, "simulate.duration", "in (0, inf) s"),
        "simulate, duration a length": (f'{simulate}duration = "1 mm"\n', 3, "simulate.duration", "expected s (a time)"),
        "simulate, unknown method": (f'{simulate}method = "euler"\n', 3, "simulate.method", "unknown name 'euler'"),
        "simulate, unknown contact": (f'{simulate}contact = "exakt"\n', 3, "simulate.contact", "'exact'"),
        "simulate, unknown start": (f'{simulate}start = "sliding "\n', 3, "simulate.start", "did you mean 'sliding'?"),
        "simulate, points broken": (f"{simulate}points = 10.5\n", 3, "simulate.points", "a whole number"),
        "simulate, points with a unit": (f'{simulate}points = "10"\n', 3, "simulate.points", "a whole number"),
        "simulate, too many points": (f"{simulate}points = 1000000000000\n", 3, "simulate.points", "[2, 1e+06]"),
        "simulate, start of three": (f"{simulate}q = [1, 2, 3]\n", 3, "simulate.q", "3 numbers: expected 2"),
        "simulate, start not finite": (f"{simulate}q = [1, nan]\n", 3, "simulate.q[1]", "nan: expected"),
        "simulate, start a number": (f"{simulate}qd = 1\n", 3, "simulate.qd", "a list of numbers"),
        "onset, empty": (f"{DRUM}[onset]\n", 2, "onset", "the key 'range' is missing"),
        "onset, range missing": (f'{axis}parameter = "m"\n', 2, "onset", "the key 'range' is missing"),
        "onset, parameter missing": (f"{axis}range = [0, 1]\n", 2, "onset", "the key 'parameter' is missing"),
        "onset, unknown parameter": (
            f'{axis}parameter = "friction.statik"\nrange = [0, 1]\n', 3, "onset.parameter", "did you mean 'friction.static'?"
        ),
        "onset, parameter a number": (f"{axis}parameter = 3\nrange = [0, 1]\n", 3, "onset.parameter", "a word in quotes"),
        "onset, range of one": (f'{axis}parameter = "m"\nrange = [1]\n', 4, "onset.range", "two values such as"),
        "onset, range backwards": (f'{axis}parameter = "m"\nrange = [2, 1]\n', 4, "onset.range", "the lower value first"),
        "onset, range of nothing": (f'{axis}parameter = "m"\nrange = [1, 1]\n', 4, "onset.range", "the lower value first"),
        "onset, range not finite": (f'{axis}parameter = "m"\nrange = [1, inf]\n', 4, "onset.range[1]", "a finite number"),
        "onset, range out of bounds": (f'{axis}parameter = "m"\nrange = [-1, 1]\n', 4, "onset.range[0]", "(0, inf) kg"),
        "onset, range of another unit": (
            f'{axis}parameter = "m"\nrange = ["1 N", 2]\n', 4, "onset.range[0]", "expected kg (a mass)"
        ),
        "map, empty": (f"{DRUM}[map]\n", 2, "map", "the key 'x' is missing"),
        "map, one axis": (
            f'{DRUM}[map]\nx = {{ parameter = "m", range = [1, 2] }}\n', 2, "map", "the key 'y' is missing"
        ),
        "map, a word": (f'{DRUM}[map]\ny = "m"\n', 3, "map.y", "'m': expected a table such as"),
        "map, third axis": (f'{DRUM}[map]\nz = {{ parameter = "m" }}\n', 3, "map.z", "unknown key, one of x, y"),
        "map, too many points": (
            f'{DRUM}[map]\nx = {{ parameter = "m", range = [1, 2], points = 99999999 }}\n', 3, "map.x.points", "20001"
        ),
    }  # fmt: skip


def _own() -> dict[str, Fault]:
    """Own matrices that make no system."""
    files = {
        "outside the folder": ("../K.npy", "outside the folder"),
        "far outside": ("../../../../etc/passwd", "outside the folder"),
        "absolute": ("/etc/passwd", "outside the folder"),
        "not there": ("gone.npy", "there is no file 'gone.npy'"),
        "another ending": ("K.xls", "expected .npy, .mtx or .csv"),
        "of MATLAB": ("K.mat", "numpy.save('K.npy', scipy.io.loadmat('K.mat')['K']) makes one"),
        "a pickle": ("K.pkl", "expected .npy, .mtx or .csv"),
        "a script": ("K.py", "expected .npy, .mtx or .csv"),
        "nothing": ("", "has the ending ''"),
        "NUL": ("K\\u0000.npy", "is not a file name"),
        "very long": ("x" * 5000 + ".npy", "cannot be read"),
    }
    faults: dict[str, Fault] = {
        f"own, file {name}": (f'brake = "own"\nM = [[1]]\nK = "{path}"\n', 3, "K", words)
        for name, (path, words) in files.items()
    }
    return faults | {
        "own, nothing": ('brake = "own"\n', 1, "", "the key 'M' is missing (mass matrix, symmetric)"),
        "own, M a number": ('brake = "own"\nM = 1\n', 2, "M", "expected a list of rows"),
        "own, M a row": ('brake = "own"\nM = [1, 2]\n', 2, "M", "expected a list of rows"),
        "own, M empty": ('brake = "own"\nM = []\n', 2, "M", "expected a list of rows"),
        "own, M of empty rows": ('brake = "own"\nM = [[], []]\nK = [[1]]\n', 2, "M", "expected a list of rows"),
        "own, M ragged": ('brake = "own"\nM = [[1, 2], [3]]\n', 2, "M", "rows of 1 and 2 numbers"),
        "own, M not square": ('brake = "own"\nM = [[1, 2]]\nK = [[1]]\n', 2, "M", "a square matrix"),
        "own, M not symmetric": ('brake = "own"\nM = [[1, 2], [3, 1]]\nK = [[1, 2], [3, 1]]\n', 2, "M", "symmetric"),
        "own, M with a hole": ('brake = "own"\nM = [[1, nan], [0, 1]]\n', 2, "M[0][1]", "nan: expected"),
        "own, M with a word": ('brake = "own"\nM = [[1, "x"],\n [0, 1]]\n', 2, "M[0][1]", "is not a number"),
        "own, M three deep": ('brake = "own"\nM = [[[1]]]\n', 2, "M[0][0]", "[1]: expected"),
        "own, K of another size": ('brake = "own"\nM = [[1]]\nK = [[1, 0], [0, 1]]\n', 3, "K", "1 rows and columns"),
        "own, K in newtons": ('brake = "own"\nM = [[1]]\nK = [["1 N"]]\n', 3, "K[0][0]", "expected N/m (a stiffness)"),
        "own, K a table of nothing": ('brake = "own"\nM = [[1]]\nK = {}\n', 3, "K", "expected { file = 'K.npy'"),
        "own, K a table with more": (
            'brake = "own"\nM = [[1]]\nK = { file = "a.npy", pickle = true }\n', 3, "K", "expected { file ="
        ),
        "own, K in a file of another unit": (
            'brake = "own"\nM = [[1]]\nK = { file = "a.npy", unit = "kg" }\n', 3, "K", "expected N/m"
        ),
        "own, K in a file without a unit": (
            'brake = "own"\nM = [[1]]\nK = { file = "a.npy", unit = 3 }\n', 3, "K", "a unit in quotes"
        ),
        "own, load of another size": (f"{OWN}load = [1]\n", 4, "load", "2 forces"),
        "own, load a word": (f'{OWN}load = "1 N"\n', 4, "load", "has the ending"),
        "own, names of another count": (f'{OWN}names = ["x"]\n', 4, "names", "2 names"),
        "own, names that are paths": (f'{OWN}names = ["x", "../../y"]\n', 4, "names", "letters, digits and _"),
        "own, names twice": (f'{OWN}names = ["x", "x"]\n', 4, "names", "different names"),
        "own, names of numbers": (f"{OWN}names = [1, 2]\n", 4, "names", "a list of names"),
        "own, contacts one table": (f"{OWN}[contacts]\nn = [0, 1]\n", 4, "contacts", "under a line [[contacts]]"),
        "own, contacts numbers": (f"{OWN}contacts = [1]\n", 4, "contacts", "under a line [[contacts]]"),
        "own, contact empty": (f"{OWN}[[contacts]]\n", 4, "contacts[0]", "the key 'n' is missing"),
        "own, contact of another size": (
            f"{OWN}[[contacts]]\nn = [1]\nd = [1, 0]\n", 5, "contacts[0].n", "expected 2 numbers"
        ),
        "own, contact unknown key": (f"{CONTACT}N0 = 3\n", 7, "contacts[0].N0", "unknown key"),
        "own, contact in another unit": (f'{CONTACT}normal_force = "1 kg"\n', 7, "contacts[0].normal_force", "a force"),
        "own, contact with a broken law": (
            f'{CONTACT}friction = {{ law = "x" }}\n', 7, "contacts[0].friction.law", "unknown name 'x'"
        ),
        "own, contact unilateral by a word": (f'{CONTACT}unilateral = "yes"\n', 7, "contacts[0].unilateral", "true or"),
        "own, contact without its normal": (f"{CONTACT}unilateral = true\n", 4, "contacts[0].normal", "because it is"),
        "own, second contact": (f"{CONTACT}[[contacts]]\nn = [0, 1]\n", 7, "contacts[1]", "the key 'd' is missing"),
        "own, overflow": (f"{OWN}C = [[1e308, 1e309], [0, 0]]\n", 4, "C[0][1]", "inf: expected"),
    }  # fmt: skip


def _texts() -> dict[str, Fault]:
    """Files that are not TOML, or not text."""
    return {
        "text, no value": (f"{DRUM}m =\n", 2, "", "not TOML: invalid value"),
        "text, no quotes": (f"{DRUM}m = 1 kg\n", 2, "", "not TOML"),
        "text, open quotes": (f'{DRUM}m = "1 kg\n', 2, "", "not TOML"),
        "text, open table": (f"{DRUM}friction = {{ law = 1\n", 2, "", "not TOML"),
        "text, open list": (f"{DRUM}m = [1,\n", 3, "", "not TOML"),
        "text, colon": (f"{DRUM}m: 1\n", 2, "", "not TOML"),
        "text, JSON": ('{"brake": "drum_brake"}\n', 1, "", "not TOML"),
        "text, YAML": ("brake: drum_brake\nm: 1\n", 1, "", "not TOML"),
        "text, XML": ("<brake/>\n", 1, "", "not TOML"),
        "text, key twice": (f"{DRUM}m = 1\nm = 2\n", 3, "", "cannot overwrite a value"),
        "text, table twice": (f"{DRUM}[modes]\n[modes]\n", 3, "", "not TOML: cannot declare"),
        "text, key of a value": (f"{DRUM}m = 1\nm.a = 2\n", 3, "", "not TOML"),
        "text, leading zero": (f"{DRUM}m = 01\n", 2, "", "not TOML"),
        "text, bare control character": (f"{DRUM}m = 1 \x01\n", 2, "", "not TOML"),
        "text, escape": (f'{DRUM}m = "\\q"\n', 2, "", "not TOML"),
        "text, surrogate": (f'{DRUM}m = "\\ud800"\n', 2, "", "not TOML"),
        "text, number of five thousand digits": (f"{DRUM}m = {'9' * 5000}\n", 0, "", "not TOML: exceeds the limit"),
        "text, brackets of hell": (f"{DRUM}m = {'[' * 100000}\n", 0, "", "nested too deeply"),
        "text, tables of hell": (f"{DRUM}m = {'{a=' * 20000}\n", 0, "", "nested too deeply"),
        "bytes, random": (bytes(range(256)) * 4, 2, "", "is not UTF-8 text"),
        "bytes, UTF-16": (DRUM.encode("utf-16"), 1, "", "byte 0xff is not UTF-8"),
        "bytes, Latin-1": (b'brake = "drum_brake"\n# \xe9\n', 2, "", "byte 0xe9 is not UTF-8"),
        "bytes, zip": (b"PK\x03\x04\x14\x00\x00\x00\x08\x00", 1, "", "not TOML"),
        "bytes, PNG": (b"\x89PNG\r\n\x1a\n" + bytes(100), 1, "", "byte 0x89 is not UTF-8"),
        "bytes, NUL": (bytes(4096), 1, "", "not TOML"),
        "bytes, two megabytes": (b"# " + b"x" * 2_000_000, 0, "", "expected at most 1000000"),
        "bytes, byte order mark twice": ("\ufeff\ufeffm = 1\n".encode(), 1, "", "not TOML"),
    }


HOSTILE: dict[str, Fault] = {**_values(), **_units(), **_keys(), **_sections(), **_own(), **_texts()}
