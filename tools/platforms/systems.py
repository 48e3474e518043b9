"""The supported systems: how debootstrap makes them, and which mirrors the host knows."""
import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

KEYRINGS = Path("/usr/share/keyrings")
# The last words of debootstrap where a mirror, or the system on it, does not answer.
UNREACHABLE = re.compile(r"^E: (.*(?:Failed getting|Couldn't download|Invalid Release file|Failed to get).*)$", re.M)


@dataclass(frozen=True)
class System:
    name: str
    distribution: str  # as the Origin of its archive
    suite: str
    script: str  # the name of a script of debootstrap; older versions do not have one for newer suites
    keyring: str
    components: tuple[str, ...] = ("main",)


SYSTEMS = {system.name: system for system in (
    System("debian12", "Debian", "bookworm", "sid", "debian-archive-keyring.gpg"),
    System("debian13", "Debian", "trixie", "sid", "debian-archive-keyring.gpg"),
    System("ubuntu24.04", "Ubuntu", "noble", "gutsy", "ubuntu-archive-keyring.gpg", ("main", "universe")),
)}  # fmt: skip


class Unreachable(Exception):
    """The system cannot be made here: no mirror answers, or no key confirms it. The message is the reason."""


def output_of(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else ""


def mirror_of(distribution, targets=None):
    """The mirror of a distribution: DVI_MIRROR_DEBIAN or DVI_MIRROR_UBUNTU, or the one that apt of this machine uses.

    Empty if apt uses none: debootstrap then uses its own default. `targets` replaces the output of apt.
    """
    given = os.environ.get(f"DVI_MIRROR_{distribution.upper()}")
    if given:
        return given
    if targets is None:
        targets = output_of("apt-get", "indextargets", "--format", "$(ORIGIN)|$(LABEL)|$(REPO_URI)", "Created-By: Packages")
    for line in targets.splitlines():
        origin, label, uri = line.split("|", 2)
        if origin == label == distribution:  # security updates have a label of their own
            return uri.rstrip("/")
    return ""


def proxies():
    """The lines of apt's configuration that name proxies; the new systems get the same."""
    return [line for line in output_of("apt-config", "dump").splitlines() if re.match(r"Acquire::https?::.*Proxy.* \"..*\";$", line)]


def proxy_environment():
    found = {}
    for line in proxies():
        match = re.match(r'Acquire::(https?)::Proxy "(.+)";$', line)
        if match and match[2] != "DIRECT":
            found[f"{match[1]}_proxy"] = match[2]
    return found


def keyring_of(system, folders):
    """The file with the keys that sign the system, in the first of the folders that has it."""
    for folder in folders:
        if (folder / system.keyring).is_file():
            return folder / system.keyring
    raise Unreachable(f"no file {system.keyring} in {' or '.join(str(folder) for folder in folders)} to verify it with")


def bootstrap(system, target, cache, keyring, log):
    """Makes the bare system in `target`. Raises Unreachable if its mirror does not answer."""
    cache.mkdir(parents=True, exist_ok=True)
    (cache / "wgetrc").write_text("timeout = 30\ntries = 3\n")
    environment = os.environ | proxy_environment() | {"WGETRC": str(cache / "wgetrc"), "LC_ALL": "C"}
    command = ["debootstrap", "--variant=minbase", "--force-check-gpg", f"--keyring={keyring}", f"--cache-dir={cache}",
               f"--components={','.join(system.components)}", "--include=ca-certificates", system.suite, str(target),
               mirror_of(system.distribution), system.script]  # fmt: skip
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    log.write_text(done.stdout)
    if done.returncode == 0:
        return
    reason = UNREACHABLE.search(done.stdout)
    if reason:
        raise Unreachable(f"debootstrap: {reason[1].strip()}")
    raise RuntimeError(f"debootstrap failed with {done.returncode}; see {log}")
