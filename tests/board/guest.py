"""The emulated board: Debian's arm64 kernel and an initial file system with the cross-built wireposed."""
import gzip
import os
import pathlib
import re
import shutil
import subprocess

from errors import Unavailable

HERE = pathlib.Path(__file__).resolve().parent
TRIPLE = "aarch64-linux-gnu"
LIBRARY_FOLDERS = (f"usr/lib/{TRIPLE}", f"lib/{TRIPLE}", f"usr/lib/{TRIPLE}/systemd", f"lib/{TRIPLE}/systemd")
LOADER = "lib/ld-linux-aarch64.so.1"
# What the board runs besides the sysroot's libraries; the kernel's name has its version and is found by apt.
PACKAGES = ("busybox-static", "udev", "libblkid1", "libkmod2", "libpcre2-8-0", "libselinux1")
MODULES = ("virtio_pci", "virtio_net", "xhci_pci", "uvcvideo")
APPLETS = ("sh", "cut", "dmesg", "ip", "killall", "ls", "mkdir", "modprobe", "mount", "poweroff", "sed", "start-stop-daemon",
           "tail", "uname", "xargs")
RULES = ("80-drivers.rules",)


class Packages:
    """Fetches arm64 packages into a folder of its own, with apt's state in `world` (that of scripts/sysroot)."""

    def __init__(self, world, folder):
        self._folder = folder
        self._options = ["-o", "APT::Architecture=arm64", "-o", "APT::Architectures=arm64", "-o", f"Dir::State={world}/state",
                         "-o", f"Dir::State::status={world}/state/status", "-o", f"Dir::Cache={world}/cache",
                         "-o", "Dir::Etc::preferencesparts=/dev/null", "-o", "APT::Sandbox::User=", "-o", "Debug::NoLocking=1",
                         "-o", "Acquire::Languages=none", "-o", "APT::Get::List-Cleanup=0"]
        folder.mkdir(parents=True, exist_ok=True)

    def _apt(self, tool, *arguments):
        return subprocess.run([tool, *self._options, "-qq", *arguments], cwd=self._folder, capture_output=True, text=True)

    def kernel(self):
        """The package of the newest stock kernel."""
        def newest():
            return re.search(r"Depends: (linux-image-\S+)", self._apt("apt-cache", "depends", "linux-image-arm64").stdout)

        found = newest()
        if not found:
            self._apt("apt-get", "update")
            found = newest()
        if not found:
            raise Unavailable("the package sources have no linux-image-arm64; add Debian's main to /etc/apt")
        return found.group(1)

    def unpack(self, names):
        """Folder with the contents of all; kept for the next time."""
        root = self._folder / "root"
        done = self._folder / "unpacked"
        text = "\n".join(names)
        if done.exists() and done.read_text() == text:
            return root
        shutil.rmtree(root, ignore_errors=True)
        for name in names:
            if not list(self._folder.glob(f"{name}_*.deb")):
                fetched = self._apt("apt-get", "download", name)
                if fetched.returncode:  # a security update may have replaced it since the lists were fetched
                    self._apt("apt-get", "update")
                    fetched = self._apt("apt-get", "download", name)
                if fetched.returncode:
                    raise Unavailable(f"{name} for arm64 cannot be fetched ({fetched.stderr.strip().splitlines()[-1]})")
            subprocess.run(["dpkg-deb", "-x", next(self._folder.glob(f"{name}_*.deb")), root], check=True)
        done.write_text(text)
        return root


class Image:
    """An initial file system under construction in `folder`; what is copied is looked for in `roots`, in order."""

    def __init__(self, folder, roots):
        self._folder, self._roots = folder, roots
        shutil.rmtree(folder, ignore_errors=True)
        for name in ("bin", "dev", "etc", "lib", "proc", "run", "sys", "tmp", f"usr/lib/{TRIPLE}", "usr/bin"):
            (folder / name).mkdir(parents=True)

    def find(self, *paths):
        for root in self._roots:
            for path in paths:
                if (root / path).exists():
                    return root / path
        raise Unavailable(f"{paths[0]} is in none of the board's packages; see tests/board/guest.py")

    def copy(self, source, target, mode=0o644):
        target = self._folder / target
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        target.chmod(mode)

    def write(self, target, text):
        (self._folder / target).parent.mkdir(parents=True, exist_ok=True)
        (self._folder / target).write_text(text)

    def program(self, source, target):
        """With the libraries that it needs."""
        self.copy(source, target, 0o755)
        self._libraries(source)

    def _libraries(self, binary):
        dump = subprocess.run(["objdump", "-p", binary], capture_output=True, text=True, check=True).stdout
        for name in re.findall(r"NEEDED\s+(\S+)", dump):
            target = f"usr/lib/{TRIPLE}/{name}"
            if name.startswith("ld-linux") or (self._folder / target).exists():
                continue
            source = self.find(*(f"{folder}/{name}" for folder in LIBRARY_FOLDERS))
            self.copy(source, target)
            self._libraries(source)

    def modules(self, release, names):
        """Kernel modules with those that they depend on."""
        tree = self.find(f"lib/modules/{release}")
        if not (tree / "modules.dep").exists():
            subprocess.run(["depmod", "-b", tree.parents[2], release], check=True)
        needs = dict(line.split(":") for line in (tree / "modules.dep").read_text().splitlines())
        by_name = {pathlib.Path(path).stem.replace("-", "_"): path for path in needs}
        for name in names:
            if name not in by_name:
                continue  # built into the kernel
            for path in (by_name[name], *needs[by_name[name]].split()):
                self.copy(tree / path, f"lib/modules/{release}/{path}")
        for name in ("modules.order", "modules.builtin", "modules.builtin.modinfo"):
            self.copy(tree / name, f"lib/modules/{release}/{name}")
        subprocess.run(["depmod", "-b", self._folder, release], check=True)

    def pack(self, target):
        names = subprocess.run(["find", ".", "-print0"], cwd=self._folder, capture_output=True, check=True).stdout
        archive = subprocess.run(["cpio", "--null", "-o", "-H", "newc", "--quiet", "-R", "0:0"], cwd=self._folder, input=names,
                                 capture_output=True, check=True).stdout
        target.write_bytes(gzip.compress(archive, 1))


def build(world, sysroot, work, wireposed, files):
    """Makes kernel and initial file system in `work`: (kernel, initrd). `files` maps paths in the image to files that
    wireposed reads. Unavailable when a package cannot be had."""
    packages = Packages(world, work / "packages")
    kernel = packages.kernel()
    root = packages.unpack([kernel, *PACKAGES])
    release = kernel.removeprefix("linux-image-")
    image = Image(work / "initrd", [root, sysroot])
    image.copy(image.find("bin/busybox", "usr/bin/busybox"), "bin/busybox", 0o755)
    for applet in APPLETS:
        os.symlink("busybox", work / "initrd/bin" / applet)
    image.copy(image.find(LOADER), LOADER, 0o755)
    image.program(image.find("bin/udevadm", "usr/bin/udevadm"), "usr/bin/udevadm")
    os.symlink("udevadm", work / "initrd/usr/bin/systemd-udevd")
    for rules in RULES:
        image.copy(image.find(f"lib/udev/rules.d/{rules}", f"usr/lib/udev/rules.d/{rules}"), f"lib/udev/rules.d/{rules}")
    image.copy(HERE.parents[1] / "config/60-wirepose.rules", "lib/udev/rules.d/60-wirepose.rules")
    image.write("etc/passwd", "root:x:0:0::/:/bin/sh\nnobody:x:65534:65534::/:/bin/sh\n")
    image.write("etc/group", "root:x:0:\nvideo:x:44:\nnogroup:x:65534:\n")
    image.modules(release, MODULES)
    image.program(wireposed, "usr/bin/wireposed")
    for target, source in files.items():
        image.copy(source, target)
    image.copy(HERE / "init", "init", 0o755)
    image.pack(work / "initrd.gz")
    return image.find(f"boot/vmlinuz-{release}"), work / "initrd.gz"
