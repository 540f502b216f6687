"""A bake that is stopped by force: its command, what it said until then, and what it left on the disk."""
import ctypes
import json
import os
import re
import shutil
import signal
import subprocess
import threading

LIMIT = 600  # seconds; nothing here takes so long
TEMPORARY = ".tmp-"
RESUMING = re.compile(r"resuming: ([\d,]+) of ")
ERROR = re.compile(r"sightcell: .+; .+ \[([a-z]+\.[a-z-]+)\]")


class Ended:
    """What is known of a run of the program."""

    def __init__(self, code, output, errors):
        self.code, self.output = code, output
        self.lines = errors.splitlines()
        done = [json.loads(line)["cells"] for line in self.lines if line.startswith("{") and line.endswith("}")]
        self.reported = max(done, default=0)  # finished cells, those of runs before included
        found = RESUMING.search(errors)
        self.resumed = int(found.group(1).replace(",", "")) if found else None
        if code in (0, 3) and output:
            self.resumed = json.loads(output)["cells_resumed"]
        self.error_lines = [line for line in self.lines if line.startswith("sightcell: ")]

    def error(self):
        """The id of the one line of error; nothing where there is none or more than one."""
        match = ERROR.fullmatch(self.error_lines[0]) if len(self.error_lines) == 1 else None
        return match.group(1) if match else None


class Victim:
    """One command of `sightcell bake` in a folder that holds nothing else; whole: the bytes it gives undisturbed."""

    def __init__(self, program, scene, folder, options):
        self.program, self.scene, self.folder, self.options = program, scene, folder, options
        os.makedirs(folder, exist_ok=True)
        self.output = os.path.join(folder, "level.pvs")
        self.checkpoint = self.output + ".bake"
        self.whole = None

    def command(self, *more):
        return [self.program, "bake", self.scene, "-o", self.output, "--source", "cpu", "--progress", "json", "--json",
                *self.options, *more]

    def start(self, *more, before=()):
        return subprocess.Popen([*before, *self.command(*more)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, errors="replace")

    def run(self, *more, before=(), kill_after=LIMIT, kill_when=None, kill_at_cell=None):
        """Runs to the end; or is killed after so many seconds, when kill_when() says so, or when so many cells are done."""
        running = self.start(*more, before=before)
        timer = threading.Timer(kill_after, running.kill)
        timer.daemon = True
        timer.start()
        said = ""
        while kill_when and running.poll() is None:
            if kill_when():
                running.kill()
        while kill_at_cell and (line := running.stderr.readline()):
            said += line
            if Ended(None, "", said).reported >= kill_at_cell:
                running.kill()
        output, errors = running.communicate()
        timer.cancel()
        return Ended(running.returncode, output, said + errors)

    def left(self):
        """Names beside the output that a finished bake does not leave."""
        return sorted(name for name in os.listdir(self.folder) if name != os.path.basename(self.output))

    def content(self):
        try:
            with open(self.output, "rb") as file:
                return file.read()
        except FileNotFoundError:
            return None

    def is_wrong(self):
        """Is there an output, and not the right one?"""
        content = self.content()
        return content is not None and content != self.whole

    def is_writing(self):
        try:
            return any(TEMPORARY in name for name in os.listdir(self.folder))
        except FileNotFoundError:
            return False

    def clear(self):
        for name in os.listdir(self.folder):
            path = os.path.join(self.folder, name)
            shutil.rmtree(path) if os.path.isdir(path) and not os.path.islink(path) else os.remove(path)


def own_mounts():
    """From here on this process mounts for itself alone, and what it mounted goes when it ends. May it?"""
    new_mount_namespace = 0x00020000
    if os.geteuid() != 0 or ctypes.CDLL(None, use_errno=True).unshare(new_mount_namespace) != 0:
        return False
    return subprocess.run(["mount", "--make-rprivate", "/"], capture_output=True).returncode == 0


class SmallDisk:
    """A disk of so many bytes, in memory, at folder; `with` unmounts it."""

    def __init__(self, folder, size):
        self.folder, self.size = folder, size
        self.ballast = os.path.join(folder, "ballast")

    def __enter__(self):
        os.makedirs(self.folder, exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.size}", "none", self.folder], check=True)
        return self

    def __exit__(self, *_):
        subprocess.run(["umount", "-l", self.folder], check=True)

    def leave(self, free):
        """Fills the disk up to so many bytes."""
        self.make_room()
        disk = os.statvfs(self.folder)
        with open(self.ballast, "wb") as out:
            out.write(bytes(max(0, disk.f_bavail * disk.f_frsize - free)))

    def make_room(self):
        if os.path.exists(self.ballast):
            os.remove(self.ballast)
