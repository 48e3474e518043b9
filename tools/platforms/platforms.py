#!/usr/bin/env python3
"""Tests the committed tree on the supported systems: bare ones, made by debootstrap.

    platforms.py [--keep] [--packages DIR] [SYSTEM ...]

In each system, an unprivileged user with sudo runs the commands of the README and builds the packages. A second bare system
installs the packages and uses them. Downloads, the bare systems, ccache's folders, and logs are kept in build/platforms, or in
the folder $DVI_PLATFORMS. Exit code 1 if anything failed; a system that cannot be downloaded is untested, which is not a failure.
"""
import argparse
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from chroot import HOME, USER, Chroot
from measure import Result, lintian_in, table, tests_in, warnings_in
from systems import KEYRINGS, SYSTEMS, Unreachable, bootstrap, keyring_of, output_of, proxies

ROOT = Path(__file__).resolve().parents[2]
WORK = Path(os.environ.get("DVI_PLATFORMS") or ROOT / "build" / "platforms").resolve()
TRIAL = Path(__file__).with_name("trial.sh")
INSTALL = "apt-get install -y --no-install-recommends"


class Failed(Exception):
    """A step failed; the message names its log."""


def say(text):
    print(f"\n== {text}", file=sys.stderr, flush=True)


def base_of(system):
    """The bare system, made once."""
    folder = WORK / system.name
    base = folder / "base"
    if not base.is_dir():
        say(f"{system.name}: debootstrap {system.suite}")
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = folder / "base.new"
        subprocess.run(["rm", "-rf", "--one-file-system", unfinished], check=True)
        bootstrap(system, unfinished, folder / "archives", keyring_of(system, keyring_folders(system)), folder / "debootstrap.log")
        unfinished.rename(base)
    return base


def keyring_folders(system):
    """Debian 12 has no package of Ubuntu's keys, but Debian 13 has one."""
    if (KEYRINGS / system.keyring).is_file() or system.distribution != "Ubuntu":
        return [KEYRINGS]
    debian = SYSTEMS["debian13"]
    keys = chroot_of(debian, "keys")
    keys.create(base_of(debian), proxies())
    keys.call(f"apt-get update && {INSTALL} ubuntu-keyring")
    folder = WORK / system.name / "keyrings"
    shutil.copytree(keys.root / KEYRINGS.relative_to("/"), folder, dirs_exist_ok=True)
    keys.remove()
    return [folder]


def chroot_of(system, name):
    folder = WORK / system.name
    shared = {folder / "archives": "/var/cache/apt/archives", folder / "ccache": "/var/cache/ccache"}
    for outside in shared:
        outside.mkdir(parents=True, exist_ok=True)
    return Chroot(folder / name, shared)


class Steps:
    """Runs the steps of one system in one chroot and enters their minutes in its result."""

    def __init__(self, system, chroot, result):
        self.chroot, self.result, self.folder = chroot, result, WORK / system.name

    def run(self, name, command, user=USER, timed=False):
        """Runs it and returns its output. Raises Failed, with the end of the output on stderr, if it fails."""
        say(f"{self.result.system}: {name}")
        log = self.folder / (name.strip("./").replace(" ", "_") + ".log")
        begin = time.monotonic()
        code = self.chroot.run(command, log, user)
        if timed:
            self.result.figures[f"{name}, minutes"] = f"{(time.monotonic() - begin) / 60:.1f}"
        text = log.read_text(encoding="utf-8", errors="replace")
        if code != 0:
            print("\n".join(text.splitlines()[-40:]), file=sys.stderr)
            self.result.failures.append(f"{name} failed with {code}; see {log}")
            raise Failed(name)
        return text


def build(system, base, result, keep):
    """Runs the commands of the README and ./dev package in a copy of the bare system. Returns the folder of the packages."""
    chroot = chroot_of(system, "root")
    chroot.create(base, proxies())
    chroot.call("apt-get update && " + INSTALL + f" git sudo && echo '{USER} ALL=(ALL) NOPASSWD: ALL' >/etc/sudoers.d/{USER}"
                f" && chown {USER}: /var/cache/ccache")  # fmt: skip
    clone = chroot.root / HOME.strip("/") / "dvi"
    subprocess.run(["git", "-c", "advice.detachedHead=false", "clone", "--quiet", "--no-hardlinks", ROOT, clone], check=True)
    chroot.call(f"chown -R {USER}: {HOME}")
    bare = chroot.megabytes()
    steps, texts = Steps(system, chroot, result), []
    for verb in ("setup", "build", "demo"):
        texts.append(steps.run(f"./dev {verb}", f"cd dvi && ./dev {verb}", timed=True))
        if verb == "setup":
            result.figures["./dev setup installs, MB"] = str(chroot.megabytes() - bare)
    try:
        texts.append(steps.run("./dev test", "cd dvi && ./dev test", timed=True))
    except Failed:  # the packages are built all the same
        texts.append((steps.folder / "dev_test.log").read_text(encoding="utf-8", errors="replace"))
    enter_tests(texts[-1], result)
    enter_warnings("".join(texts), result)
    result.figures["disk in all, MB"] = str(chroot.megabytes())
    steps.run("./dev package", "cd dvi && ./dev package", timed=True)
    packages = WORK / system.name / "packages"
    shutil.rmtree(packages, ignore_errors=True)
    shutil.copytree(clone / "build/release/packages", packages)
    if not keep:
        chroot.remove()
    return packages


def enter_tests(text, result):
    found = tests_in(text)
    result.figures["tests passed / failed / skipped"] = " / ".join(map(str, found)) if found else "none ran"


def enter_warnings(text, result):
    found = warnings_in(text)
    result.figures["warnings of compiler and CMake"] = str(len(found))
    if found:
        result.failures.append("\n  ".join(["warnings:", *found]))


def try_packages(system, base, packages, result, keep):
    """Installs the packages in a bare system, where nothing else was installed, and uses them; see trial.sh."""
    chroot = chroot_of(system, "bare")
    chroot.create(base, proxies())
    inside = chroot.root / HOME.strip("/")
    shutil.copytree(packages, inside / "packages")
    shutil.copytree(ROOT / "examples", inside / "examples")
    shutil.copyfile(TRIAL, inside / "trial.sh")
    chroot.call(f"chown -R {USER}: {HOME} && apt-get update")
    steps, before = Steps(system, chroot, result), chroot.megabytes()
    installed = [f"{HOME}/packages/{name}_*.deb" for name in ("dvi", "python3-dvi", "libdvi-dev")]
    steps.run("apt install dvi", f"{INSTALL} {installed[0]}", "root")
    result.figures["dvi and its dependencies, MB"] = str(chroot.megabytes() - before)
    steps.run("trial program", "bash trial.sh program")
    steps.run("apt install python3-dvi", f"{INSTALL} {installed[1]}", "root")
    steps.run("trial python", "bash trial.sh python")
    steps.run("apt install libdvi-dev", f"{INSTALL} {installed[2]} g++ cmake make", "root")
    steps.run("trial library", "bash trial.sh library")
    steps.run("apt purge", "apt-get purge -y dvi python3-dvi libdvi-dev", "root")
    result.figures["packages installed and used"] = "all 3"
    steps.run("apt install lintian", f"{INSTALL} lintian", "root")
    text = steps.run("lintian", "lintian --tag-display-limit 0 packages/*.deb || (($? == 2))")
    errors, warnings = lintian_in(text)
    result.figures["lintian errors / warnings"] = f"{len(errors)} / {len(warnings)}"
    if errors:
        result.failures.append("\n  ".join(["lintian:", *errors]))
    if not keep:
        chroot.remove()


def test(system, given, keep):
    """The result of one system. `given` is a folder of packages to try, or None to build all."""
    result = Result(system.name)
    try:
        base = base_of(system)
        try_packages(system, base, given or build(system, base, result, keep), result, keep)
    except Unreachable as reason:
        result.untested = str(reason)
    except Failed:
        pass
    except (RuntimeError, subprocess.CalledProcessError, OSError) as reason:
        result.failures.append(str(reason))
    return result


def main():
    arguments = argparse.ArgumentParser(prog="./dev platforms", description="Tests the committed tree on the supported systems.")
    arguments.add_argument("systems", metavar="SYSTEM", nargs="*", help=f"of {', '.join(SYSTEMS)}; without any, all of them")
    arguments.add_argument("--keep", action="store_true", help="keep the systems in which it was built and installed")
    arguments.add_argument("--packages", type=Path, metavar="DIR", help="only install and use these packages of one SYSTEM")
    arguments = arguments.parse_args()
    unknown = [name for name in arguments.systems if name not in SYSTEMS]
    if unknown:
        sys.exit(f"platforms: '{unknown[0]}' is not one of {', '.join(SYSTEMS)}")
    if arguments.packages and len(arguments.systems) != 1:
        sys.exit("platforms: --packages needs one SYSTEM")
    if os.geteuid() != 0:
        sys.exit("platforms: needs root, to make and enter systems: sudo ./dev platforms")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the command that runs in a system ends as well
    results = [test(SYSTEMS[name], arguments.packages, arguments.keep) for name in arguments.systems or SYSTEMS]
    commit = output_of("git", "-C", str(ROOT), "rev-parse", "--short", "HEAD").strip()
    print(f"\ncommit {commit}, {os.cpu_count()} cores\n\n{table(results)}")
    for result in results:
        if result.untested:
            print(f"\n{result.system}: untested: {result.untested}")
        for failure in result.failures:
            print(f"\n{result.system}: {failure}")
    sys.exit(any(result.failures for result in results))


if __name__ == "__main__":
    main()
