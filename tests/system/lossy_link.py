#!/usr/bin/env python3
"""A bad network between two hosts that are network namespaces: usage lossy_link.py NAME LOSS DELAY_MS (as root).

Makes the namespaces NAME-a (10.77.0.1) and NAME-b (10.77.0.2), each with an interface wp0, carries packets between them
with that share lost and that delay, prints "ready", and loses all of them from SIGUSR1 until SIGUSR2. SIGTERM ends it and
removes all. It exists because the kernel at hand has no netem.
"""
import ctypes
import fcntl
import heapq
import os
import random
import select
import signal
import struct
import subprocess
import sys
import time

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
CLONE_NEWNET = 0x40000000
MTU = 1500
g_cut = False


def set_cut(cut):
    global g_cut
    g_cut = cut


def run(*command):
    subprocess.run(command, check=True)


def open_tunnel(namespace, address, peer):
    """A file descriptor whose reads and writes are the packets of wp0 in the namespace."""
    run("ip", "netns", "add", namespace)
    libc = ctypes.CDLL(None, use_errno=True)
    home = os.open("/proc/self/ns/net", os.O_RDONLY)
    there = os.open(f"/var/run/netns/{namespace}", os.O_RDONLY)
    if libc.setns(there, CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "setns")
    tunnel = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(tunnel, TUNSETIFF, struct.pack("16sH", b"wp0", IFF_TUN | IFF_NO_PI))
    if libc.setns(home, CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "setns")
    inside = ("ip", "-n", namespace)
    run(*inside, "address", "add", address, "peer", peer, "dev", "wp0")
    run(*inside, "link", "set", "wp0", "up")
    run(*inside, "link", "set", "lo", "up")
    return tunnel


def carry(tunnels, loss, delay_s):
    waiting = []  # (time, number, tunnel, packet)
    number = 0
    choose = random.Random(1)
    while True:
        pause = max(0.0, waiting[0][0] - time.monotonic()) if waiting else None
        ready, _, _ = select.select(tunnels, [], [], pause)
        for tunnel in ready:
            packet = os.read(tunnel, MTU + 100)
            if g_cut or choose.random() < loss:
                continue
            number += 1
            other = tunnels[1] if tunnel == tunnels[0] else tunnels[0]
            heapq.heappush(waiting, (time.monotonic() + delay_s, number, other, packet))
        while waiting and waiting[0][0] <= time.monotonic():
            _, _, tunnel, packet = heapq.heappop(waiting)
            os.write(tunnel, packet)


def main():
    name, loss, delay_ms = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
    names = [f"{name}-a", f"{name}-b"]
    signal.signal(signal.SIGUSR1, lambda *_: set_cut(True))
    signal.signal(signal.SIGUSR2, lambda *_: set_cut(False))
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    try:
        tunnels = [open_tunnel(names[0], "10.77.0.1", "10.77.0.2"), open_tunnel(names[1], "10.77.0.2", "10.77.0.1")]
        print("ready", flush=True)
        carry(tunnels, loss, delay_ms / 1000)
    finally:
        for namespace in names:
            subprocess.run(("ip", "netns", "delete", namespace), stderr=subprocess.DEVNULL)


main()
