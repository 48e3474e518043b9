"""Runs the program with limits, and measures its resources."""
import contextlib
import os
import resource
import subprocess
import tempfile
import time
from typing import NamedTuple

SECONDS = 60
MEMORY_BYTES = 1 << 30       # resident; more is a finding
DATA_BYTES = 3 << 30         # allocated; protects the machine from excessive memory


class Ended(NamedTuple):
    """The result of a call; `code` is the exit code, 128 + n after signal n, or None after the time limit."""
    arguments: tuple
    code: int | None
    err: str
    cpu: float
    peak_bytes: int


class Program:
    """The program under test, with its limits."""

    def __init__(self, path, seconds=SECONDS):
        self.path, self.seconds = str(path), seconds

    def start(self, *arguments, err=subprocess.DEVNULL, file_bytes=None):
        """Starts a call in a new session. Writing beyond `file_bytes` of a file fails as on a full disk."""
        process = subprocess.Popen([self.path, *map(str, arguments), "--quiet"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=err, start_new_session=True,
                                   restore_signals=file_bytes is None)  # Python ignores SIGXFSZ, and so does the call then
        limits = {resource.RLIMIT_CORE: 0}
        if "asan" not in self.path and "tsan" not in self.path:  # sanitizers reserve terabytes
            limits[resource.RLIMIT_DATA] = DATA_BYTES
        if file_bytes is not None:
            limits[resource.RLIMIT_FSIZE] = file_bytes
        with contextlib.suppress(ProcessLookupError):  # it may have ended
            for limit, value in limits.items():
                resource.prlimit(process.pid, limit, (value, value))
        return process

    def call(self, *arguments, file_bytes=None):
        with tempfile.TemporaryFile() as err:
            process = self.start(*arguments, err=err, file_bytes=file_bytes)
            code, usage = wait(process, self.seconds)
            err.seek(0)
            text = err.read(1 << 20).decode("utf-8", "backslashreplace")
        return Ended(arguments, code, text, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def wait(process, seconds):
    """Returns exit code and resources of a process, which is killed after the time limit."""
    end, late = time.monotonic() + seconds, False
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            code = os.waitstatus_to_exitcode(status)
            process.returncode = code
            return None if late else code if code >= 0 else 128 - code, usage
        if time.monotonic() > end and not late:
            late = True
            process.kill()
        time.sleep(0.005)
