"""Runs commands in a system that lies in a folder."""
import shutil
import subprocess
from pathlib import Path

USER = "builder"
HOME = f"/home/{USER}"
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"

# ROOT USER COMMAND [OUTSIDE INSIDE]...: its mounts are private and end with the command, as do all its processes. The shell stays
# the first process, as root: where it is killed, so are all others. A process that changes its user loses --kill-child.
ENTER = r"""
set -eu
root=$1 user=$2 command=$3
shift 3
mount -t proc proc "$root/proc"
mount -t sysfs -o ro sysfs "$root/sys"
mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"
mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
while [ $# -gt 0 ]; do
  mkdir -p "$root$2"
  mount --bind "$1" "$root$2"
  shift 2
done
home=/root
[ "$user" = root ] || home=/home/$user
env -i PATH="$0" HOME="$home" USER="$user" LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive CCACHE_DIR=/var/cache/ccache \
  chroot --userspec="$user" "$root" bash -c 'cd; eval "$1"' bash "$command"
exit 0
"""


class Chroot:
    """A copy of a bare system. `shared` maps folders of this machine to folders inside; no others are visible there."""

    def __init__(self, root, shared):
        self.root = Path(root)
        self.shared = {Path(outside): inside for outside, inside in shared.items()}

    def create(self, base, proxies):
        """Copies the bare system, adds the user, and takes name resolution and proxies from this machine."""
        self.remove()
        subprocess.run(["cp", "-a", base, self.root], check=True)
        for name in ("resolv.conf", "hosts"):
            (self.root / "etc" / name).unlink(missing_ok=True)
            shutil.copyfile(Path("/etc") / name, self.root / "etc" / name)
        (self.root / "etc/apt/apt.conf.d/90host").write_text("".join(line + "\n" for line in proxies))
        services = self.root / "usr/sbin/policy-rc.d"  # packages start none
        services.write_text("#!/bin/sh\nexit 101\n")
        services.chmod(0o755)
        self.call(f"useradd --create-home --shell /bin/bash --uid 1000 {USER}")

    def remove(self):
        if self.root.exists():
            subprocess.run(["rm", "-rf", "--one-file-system", self.root], check=True)

    def run(self, command, log, user=USER):
        """Runs it in the user's home, with its output in the file `log`. Returns the exit code."""
        pairs = [str(word) for outside, inside in self.shared.items() for word in (outside, inside)]
        words = ["unshare", "--mount", "--propagation", "private", "--pid", "--fork", "--kill-child", "sh", "-c", ENTER, PATH]
        with open(log, "w", encoding="utf-8") as out:
            return subprocess.run([*words, str(self.root), user, command, *pairs], stdin=subprocess.DEVNULL, stdout=out,
                                  stderr=subprocess.STDOUT).returncode  # fmt: skip

    def call(self, command, user="root"):
        """Runs a command that must succeed."""
        log = self.root.with_suffix(".log")
        if self.run(command, log, user) != 0:
            raise RuntimeError(f"{self.root.name}: {command}\n{log.read_text(encoding='utf-8', errors='replace')[-3000:]}")

    def megabytes(self):
        """Without shared folders, which are not mounted between commands."""
        done = subprocess.run(["du", "-sm", "--one-file-system", self.root], capture_output=True, text=True, check=True)
        return int(done.stdout.split()[0])
