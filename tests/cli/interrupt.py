# SPDX-License-Identifier: BSD-2-Clause
"""Signals and terminals: what an interrupted pzs leaves behind, and what it says on a terminal.

    interrupt.py PZS FOLDER file|device|terminal|quiet

Exits with 0 where the law holds, else with a message.
"""
import glob
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time

PATIENCE = 60  # seconds


def wait_for(what, condition):
    """Wait until condition() is true."""
    until = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > until:
            sys.exit(f"no {what} after {PATIENCE} s")
        time.sleep(0.01)


def read_until(terminal, word, until):
    """What a terminal shows until it shows `word`, its program ends, or the time is over."""
    shown = b""
    while word not in shown and time.monotonic() < until:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                part = os.read(terminal, 4096)
            except OSError:  # the program has ended
                break
            if not part:
                break
            shown += part
    return shown


def interrupted_file(pzs, folder):
    """A file that is being written when a signal comes is removed, an earlier one of its name is kept."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        path = os.path.join(folder, "kept.csv")
        with open(path, "w") as file:
            file.write("kept")
        run = subprocess.Popen([pzs, "simulate", "plate-closed-loop", "--csv", path], stdout=subprocess.DEVNULL)
        wait_for("part file", lambda: any(os.path.getsize(p) > 0 for p in glob.glob(path + ".*")))
        run.send_signal(number)
        if run.wait(PATIENCE) != -number:
            sys.exit(f"{number!r}: ended with {run.returncode}")
        if os.listdir(folder) != ["kept.csv"] or open(path).read() != "kept":
            sys.exit(f"{number!r}: left {os.listdir(folder)}")
        os.remove(path)


def interrupted_device(pzs, folder):
    """The folder of a firmware that is being built when a signal comes is removed, and make ends."""
    new = {name: value for name, value in os.environ.items() if name != "FW_OBJECTS"}  # nothing is compiled yet
    run = subprocess.Popen([pzs, "simulate", "plate-closed-loop", "--device", "host-32"], stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL, env={**new, "TMPDIR": folder})
    wait_for("object file", lambda: glob.glob(os.path.join(folder, "pzs-loop-*/firmware/*/*/*.o")))
    run.send_signal(signal.SIGINT)
    if run.wait(PATIENCE) != -signal.SIGINT:
        sys.exit(f"ended with {run.returncode}")
    time.sleep(0.5)  # a compiler that was left running would write now
    if os.listdir(folder):
        sys.exit(f"left {os.listdir(folder)}")


def on_terminal(pzs, _folder):
    """A command of more than two seconds tells on a terminal how far it is."""
    terminal, end = pty.openpty()
    began = time.monotonic()
    run = subprocess.Popen([pzs, "simulate", "plate-closed-loop", "--set", "simulate.ticks=100000"],
                           stdout=subprocess.DEVNULL, stderr=end)
    os.close(end)
    shown = read_until(terminal, b" of 100000, ", began + PATIENCE)
    seconds = [int(found) for found in re.findall(rb", (\d+) s", shown + read_until(terminal, b" s", began + PATIENCE))]
    lasted = time.monotonic() - began
    run.send_signal(signal.SIGINT)
    run.wait(PATIENCE)
    if not shown.startswith(b"\rpzs: ") or b"\rpzs: simulating the controller, " not in shown:
        sys.exit(f"shows {shown!r}")
    if not seconds or min(seconds) < 2 or max(seconds) > lasted:
        sys.exit(f"shows {seconds} after {lasted} s")


def quiet(pzs, _folder):
    """A short command shows nothing on a terminal."""
    terminal, end = pty.openpty()
    run = subprocess.Popen([pzs, "solve", "scordelis-lo"], stdout=subprocess.DEVNULL, stderr=end)
    os.close(end)
    shown = read_until(terminal, b"pzs", time.monotonic() + PATIENCE)
    if run.wait(PATIENCE) != 0 or shown:
        sys.exit(f"shows {shown!r}")


LAWS = {"file": interrupted_file, "device": interrupted_device, "terminal": on_terminal, "quiet": quiet}

if __name__ == "__main__":
    for ignored in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(ignored, signal.SIG_DFL)  # a job in the background ignores some, and pzs inherits that
    LAWS[sys.argv[3]](sys.argv[1], sys.argv[2])
