"""Machines unlike this one: Windows, which lacks parts of `os`, a plain C locale, files as editors there write them."""

import os
import subprocess
import sys

# What Windows does not have, taken away before the package is loaded; its lock of files is played by a stand-in.
AS_ON_WINDOWS = """
import os, sys, types
import asyncio, h5netcdf, matplotlib.figure, multiprocessing.pool, scipy.sparse, subprocess, xarray
for name in ("nice", "fork", "forkpty", "getuid", "geteuid", "killpg", "setsid", "sched_getaffinity", "wait3"):
    if hasattr(os, name):
        delattr(os, name)
for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[name] = None
locked = []
sys.modules["msvcrt"] = types.SimpleNamespace(LK_NBLCK=2, locking=lambda handle, mode, size: locked.append(size))
real, sys.platform = sys.platform, "win32"
import squealbox.studies.locking
sys.platform = real
from squealbox.cli import main
codes = [main(line.split("|")) for line in sys.argv[1:]]
assert not any(codes), codes
if any("run" in line for line in sys.argv[1:]):
    assert locked
"""
SMALL = """
[map]
x = { parameter = "friction.static", range = [0.1, 0.6], points = 5 }
y = { parameter = "load", range = ["0.5 kN", "5 kN"], points = 5 }

[study]
analysis = "modes"
[[study.axis]]
parameter = "friction.static"
range = [0, 1]
points = 5
"""


def away(arguments, folder, **environment):
    """`python arguments` in a folder, with changes of the environment."""
    command = [sys.executable, "-W", "error", *arguments]
    given = {**os.environ, "MPLBACKEND": "Agg", **environment}
    return subprocess.run(command, cwd=folder, env=given, capture_output=True, text=True, timeout=600)


def test_commands_run_without_what_windows_lacks(tmp_path):
    (tmp_path / "brake.toml").write_text('brake = "drum_brake"\n' + SMALL)
    lines = ["init|first", "list", "modes|brake.toml|--out|modes", "onset|brake.toml|--parameter|k3|--range|1e8|3e8",
             "map|brake.toml|--out|map", "simulate|brake.toml|--duration|5ms|--out|motion",
             "run|brake.toml|--out|s|--workers|2", "show|s", "export|s|--to|study.csv"]  # fmt: skip
    done = away(["-c", AS_ON_WINDOWS, *lines], tmp_path)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "study.csv").is_file()


def test_letters_that_the_locale_does_not_know(tmp_path):
    locale = {"LC_ALL": "C", "PYTHONUTF8": "0"}
    call = "import sys; from squealbox.cli import main; sys.exit(main())"
    assert away(["-c", call, "init", "größe", "--brake", "mass_on_belt"], tmp_path, **locale).returncode == 0
    os.rename(tmp_path / "größe" / "brake.toml", tmp_path / "größe" / "bremse_µ.toml")
    done = away(["-c", call, "modes", "größe/bremse_µ.toml", "--out", "ergebnis_ö"], tmp_path, **locale)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "ergebnis_ö" / "modes.png").is_file()


def test_a_file_as_editors_of_windows_write_it(tmp_path):
    text = 'brake = "drum_brake"\r\nload = "1 kN"\r\n'
    (tmp_path / "brake.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    call = "import sys; from squealbox.cli import main; sys.exit(main(sys.argv[1:]))"
    done = away(["-c", call, "modes", "brake.toml"], tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Steady sliding is" in done.stdout
