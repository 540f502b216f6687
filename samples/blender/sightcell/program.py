"""The program `sightcell`: where it is, and a bake that runs in the background. Knows nothing of Blender."""
import json
import os
import queue
import shutil
import subprocess
import threading

from .problem import Problem

DONE, BOUND_NOT_MET, CANCELED = 0, 3, 130  # exit codes
HELP = 'install it, or name it in Edit > Preferences > Add-ons > Sightcell'
HIDDEN = {'creationflags': getattr(subprocess, 'CREATE_NO_WINDOW', 0)}


def find(chosen):
    """The path of the program. chosen: a file, a folder with bin/sightcell (a bundle), or '' for PATH."""
    if not chosen:
        found = shutil.which('sightcell')
        if found is None:
            raise Problem(f'the program "sightcell" is not in PATH: {HELP}')
        return found
    for path in (chosen, os.path.join(chosen, 'sightcell'), os.path.join(chosen, 'bin', 'sightcell')):
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    raise Problem(f'{chosen} is not the program "sightcell": {HELP}')


def answer(path, *arguments):
    """The JSON that the program prints for a quick command."""
    try:
        done = subprocess.run([path, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              encoding='utf-8', errors='replace', timeout=60, **HIDDEN)
        if done.returncode == DONE:
            return json.loads(done.stdout)
        lines = done.stderr.strip().splitlines() or [f'exit code {done.returncode}']
        raise Problem(lines[-1])
    except (OSError, subprocess.TimeoutExpired, ValueError) as problem:
        raise Problem(f'{path}: {problem}') from None


class Job:
    """A running bake. Threads read what it prints, so that nothing here ever waits."""

    def __init__(self, command):
        self.lines = queue.Queue()
        self.progress = {}  # the last line of --progress json
        self.messages = []  # all other lines of standard error
        self.canceled = False
        self.output = ''
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                            stderr=subprocess.PIPE, text=True, encoding='utf-8', errors='replace',
                                            **HIDDEN)
        except OSError as problem:
            raise Problem(f'{command[0]} cannot be started ({problem.strerror}): {HELP}') from None
        self.readers = [threading.Thread(target=each, daemon=True) for each in (self._read_lines, self._read_output)]
        for reader in self.readers:
            reader.start()

    def _read_lines(self):
        for line in self.process.stderr:
            self.lines.put(line.rstrip('\n'))

    def _read_output(self):
        self.output = self.process.stdout.read()

    def poll(self):
        """Takes in what was printed. True when the bake has ended."""
        ended = self.process.poll() is not None and not any(reader.is_alive() for reader in self.readers)
        while not self.lines.empty():
            line = self.lines.get()
            if line.startswith('{'):
                try:
                    self.progress = json.loads(line)
                    continue
                except ValueError:
                    pass
            self.messages.append(line)
        return ended

    def cancel(self):
        """Stops the bake with SIGTERM. It keeps its finished cells in a checkpoint and ends within about a second."""
        self.canceled = True
        if self.process.poll() is None:
            self.process.terminate()

    @property
    def code(self):
        return self.process.returncode

    @property
    def summary(self):
        """The result of a bake that has ended well: docs/json-files.md, "bake"."""
        try:
            return json.loads(self.output)
        except ValueError:
            return {}


def share_of(progress):
    """How far a bake is, 0 to 1."""
    total = progress.get('cells_total', 0)
    if not total:
        return 0.0
    phase = progress.get('phase', '')
    if phase in ('writing_file', 'measuring_importance', 'finding_casters', 'finding_lights'):
        return 1.0
    return 0.9 * progress.get('cells', 0) / total + 0.1 * progress.get('cells_checked', 0) / total


def text_of(progress):
    """One line about the progress of a bake."""
    if not progress:
        return 'Loading the scene'
    phase = progress.get('phase', '')
    text = phase.replace('_', ' ').capitalize()
    if phase == 'baking_cells':
        text += f": {progress.get('cells', 0)} of {progress.get('cells_total', 0)}"
    elif phase == 'checking_neighbors':
        text += f": {progress.get('cells_checked', 0)} of {progress.get('cells_total', 0)}"
    left = progress.get('seconds_left', 0)
    if left >= 120:
        text += f', {left / 60:.0f} min left'
    elif left >= 1:
        text += f', {left:.0f} s left'
    return text
