"""What the workers of `test_workers.py` are asked."""

import os
import signal
import sys
import time


def double(tell, number):
    """Twice a number."""
    return 2 * number


def misbehaves(tell, how):
    """One of several ways not to answer as one should."""
    if how == "vanishes":
        os._exit(4)
    tell("beginning")
    tell.at(3, 5)
    if how == "prints":
        os.write(1, b"this is no pickle\n")
        print("nor is this", sys.stdin.read(), flush=True)
    elif how == "raises":
        raise ValueError("no such brake")
    elif how == "leaves":
        sys.exit("enough")
    elif how == "dies":
        print("last words", flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    elif how == "hangs":
        time.sleep(1000.0)
    elif how == "spins":
        while True:
            pass
    return how


def surroundings(tell, given):
    """What came along: the argument given with every question, a variable, the niceness, the main module's file."""
    return given, os.environ["OWN"], os.nice(0), getattr(sys.modules["__main__"], "__file__", None)
