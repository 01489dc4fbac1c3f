"""Ways to disturb a run of the command line, and what its results say, timings aside."""

import ctypes
import io
import itertools
import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd

from lineup import cli
from lineup.tables import COLUMNS

PATIENCE = 300
"""Seconds after which a run is thought to hang."""

TIMES = [heading for name, (heading, _) in COLUMNS.items() if name.startswith("seconds_")]
"""Headings of the columns of Table 2 that are timings (experiments/FORMAT.md)."""

ROOM = 100
"""Bytes of a file that still find room on a disk that is full."""

OPERATIONS = ("open", "os.mkdir", "os.rename", "os.remove")

_REFUSED = 13
_ROOT = Path(__file__).parents[1]
_CELL = re.compile(r"<t[hd].*?</t[hd]>", re.S)
_CAP_DAC_OVERRIDE, _PR_CAPBSET_DROP, _CAPABILITY_VERSION_3 = 1, 24, 0x20080522


def contents(folder):
    """What each file under a folder says, by its name, timings aside."""
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    return {file.relative_to(folder).as_posix(): _timeless(file) for file in files}


def _timeless(file):
    if file.name == "row.json":
        row = json.loads(file.read_text())
        for name in ("seconds", "digest"):  # the digest is of all else, the seconds too
            del row[name]
        row["row"] = {k: v for k, v in row["row"].items() if not k.startswith("seconds_")}
        return row
    if file.suffix == ".csv":
        table = pd.read_csv(io.BytesIO(file.read_bytes()), dtype=str, keep_default_na=False)
        return table[[c for c in table if not c.startswith("seconds")]].to_csv()
    text = file.read_text() if file.suffix in (".md", ".tex", ".html") else ""
    return _without_times(text, file.suffix) if TIMES[0] in text else file.read_bytes()


def _without_times(text, kind):
    """A table to read, as cells, without those of the columns that are timings."""
    lines = text.split("</tr>") if kind == ".html" else text.splitlines()
    split = {".md": r"(?<!\\)\|", ".tex": r" & "}.get(kind)
    rows = [re.split(split, line) if split else _CELL.findall(line) for line in lines]
    words = [[re.sub(r"<[^>]*>", "", cell).strip() for cell in row] for row in rows]
    heads = next(row for row in words if set(TIMES) <= set(row))
    kept = [k for k, word in enumerate(heads) if word not in TIMES]
    assert len(heads) - len(kept) == len(TIMES)
    return [[row[k] for k in kept] if len(row) == len(heads) else row for row in rows]


def forked(*args, before=lambda: None):
    """Run a command line in a copy of this process: (its exit code or -signal, what it said).

    `before` is called in the copy.
    """
    ours, theirs = multiprocessing.Pipe(duplex=False)
    context = multiprocessing.get_context("fork")
    process = context.Process(target=_speak, args=(list(map(str, args)), before, theirs))
    process.start()
    theirs.close()
    with os.fdopen(os.dup(ours.fileno()), encoding="utf-8") as heard:
        said = heard.read()
    process.join(PATIENCE)
    return process.exitcode, said


def _speak(args, before, pipe):
    sys.stdout = sys.stderr = os.fdopen(pipe.fileno(), "w", buffering=1, closefd=False)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # some libraries leave another
    before()
    sys.exit(cli.run(args))


def disturbed(fault, folder, number):
    """Sets up that `fault` is called at the file operation of this number in a folder."""
    operations = itertools.count()

    def hook(event, args):
        is_one = event in OPERATIONS and str(args[0]).startswith(str(folder))
        if is_one and next(operations) == number:
            fault()

    return lambda: sys.addaudithook(hook)


def kill():
    """As by kill -9."""
    os.kill(os.getpid(), signal.SIGKILL)


def interrupt():
    """As by Ctrl-C."""
    os.kill(os.getpid(), signal.SIGINT)


def fill_disk():
    """From now on, only a few bytes can be written into each file."""
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, most))


def kill_amid_writing():
    """The next file that is longer than a few bytes is cut off there, and this process killed."""
    fill_disk()
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)


def powerless():
    """Take from this process, and from what it starts, what lets root write anywhere."""
    if os.geteuid() != 0:
        return
    libc = ctypes.CDLL(None, use_errno=True)
    head = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted and inheritable, low words first
    done = libc.prctl(_PR_CAPBSET_DROP, _CAP_DAC_OVERRIDE, 0, 0, 0) == 0
    done &= libc.capget(head, sets) == 0
    for k in range(3):
        sets[k] &= ~(1 << _CAP_DAC_OVERRIDE)
    if not (done and libc.capset(head, sets) == 0):
        raise OSError(ctypes.get_errno(), "the power of root cannot be given up")


def refuses(folder):
    """Whether a folder that no one may write into refuses a process without power."""
    process = multiprocessing.get_context("fork").Process(target=_try_to_write, args=(folder,))
    process.start()
    process.join()
    return process.exitcode == _REFUSED


def _try_to_write(folder):
    powerless()
    try:
        (folder / "written").touch()
    except PermissionError:
        sys.exit(_REFUSED)


def started(*args, place, log=None):
    """The installed command in a process group of its own, started in a folder."""
    command = [Path(sys.executable).with_name("lineup"), *map(str, args)]
    return subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL if log is None else log.open("w"),
        stderr=subprocess.STDOUT,
        cwd=place,
        env=os.environ | {"PYTHONPATH": str(_ROOT)},
        start_new_session=True,
    )


def wait_until(is_so, seconds=PATIENCE):
    """Wait until something is so; a failure if it is not after some time."""
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.005)


def members(group):
    """The processes of a process group, by their numbers: what each was started as."""
    listed = subprocess.run(
        ["ps", "-ww", "-eo", "pid=,pgid=,stat=,args="], capture_output=True, text=True, check=True
    ).stdout
    rows = [line.split(None, 3) for line in listed.splitlines()]
    return {int(pid): args for pid, of, stat, args in rows if int(of) == group and stat[0] != "Z"}
