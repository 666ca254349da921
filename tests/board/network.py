"""The network between this machine and the emulated board."""
import ctypes
import os
import pathlib
import subprocess

from errors import Unavailable

CABLE, HOST_ADDRESS = "board", "10.0.2.2/24"  # the board's own address stands in tests/board/init


def enter():
    """Puts this program, and what it starts, into a network of its own that holds this machine and the board."""
    new_network, new_user = 0x40000000, 0x10000000
    uid, gid = os.getuid(), os.getgid()
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(new_network if uid == 0 else new_network | new_user):
        raise Unavailable(f"no network namespace ({os.strerror(ctypes.get_errno())}); allow them or run it as root")
    if uid != 0:
        pathlib.Path("/proc/self/setgroups").write_text("deny")
        pathlib.Path("/proc/self/uid_map").write_text(f"0 {uid} 1")
        pathlib.Path("/proc/self/gid_map").write_text(f"0 {gid} 1")
    for command in ("link set lo up", f"tuntap add dev {CABLE} mode tap", f"address add {HOST_ADDRESS} dev {CABLE}",
                    f"link set {CABLE} up"):
        done = subprocess.run(["ip", *command.split()], capture_output=True, text=True)
        if done.returncode:
            raise Unavailable(f"ip {command}: {done.stderr.strip()}; load the kernel module tun")
