#!/usr/bin/env python3
"""Seconds from a save to the preview of the nearest cells, of `sightcell bake --watch --near --keep-records --keep-found
--keep-order`. The edits are those of bench_incremental.py, near cells in the middle of the scene; after each one the
scene is saved as it was. The next save comes some seconds after a preview, while the whole bake runs; stopping that is
included, and so are the 0.3 seconds after which a save counts. Automatic cells, all threads.

usage: bench_previews.py SCENE.glb [--bin FOLDER] [--quality NAME] [--seed N] [--pause SECONDS] [--edits NAME ...]
"""
import argparse
import json
import os
import queue
import re
import statistics
import subprocess
import tempfile
import threading
import time

from bench_incremental import EDITS, OF_WALLS, Place, read_glb, versions, write_glb


class Watch:
    """A running watch, and the lines that it prints."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                        text=True)
        self.lines = queue.Queue()
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stderr:
            self.lines.put(line.strip())
        self.lines.put(None)

    def preview(self):
        """The line of the next preview."""
        seen = []
        while True:
            line = self.lines.get(timeout=900)
            if line is None:
                raise SystemExit('\n'.join(seen))
            seen.append(line)
            if ': preview of' in line:
                return line


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument('scene')
    arguments.add_argument('--bin', default='build/release/bin')
    arguments.add_argument('--quality', default='normal')
    arguments.add_argument('--seed', type=int, default=1, help='chooses the prop of each edit')
    arguments.add_argument('--pause', type=float, default=8, help='seconds between a preview and the next save')
    arguments.add_argument('--edits', nargs='+', choices=[edit.__name__ for edit in EDITS])
    given = arguments.parse_args()
    program = os.path.join(given.bin, 'sightcell')
    document, rest = read_glb(given.scene)
    listed = json.loads(subprocess.run([program, 'cells', given.scene, '--merge-cells', '0', '--json'], check=True,
                                       stdout=subprocess.PIPE).stdout)['cells']
    place = Place(document, listed, 64)
    middle = [(a + b) / 2 for a, b in zip(place.cells[0]['min'], place.cells[0]['max'])]
    with tempfile.TemporaryDirectory() as folder:
        scene, output = os.path.join(folder, 'scene.glb'), os.path.join(folder, 'scene.pvs')
        write_glb(scene, document, rest)
        began = time.monotonic()
        watch = Watch([program, 'bake', scene, '-o', output, '--watch', '--near', ','.join(map(str, middle)), '--quality',
                       given.quality, '--keep-records', '--keep-found', '--keep-order', '--source', 'cpu', '--progress',
                       'none'])

        def save(changed):
            """Seconds until the preview of a version, and its line."""
            fresh = os.path.join(folder, 'fresh.glb')
            write_glb(fresh, changed, rest)
            before, at = os.stat(output).st_ino, time.monotonic()
            os.rename(fresh, scene)
            line = watch.preview()
            assert os.stat(output).st_ino != before
            return time.monotonic() - at, line
        print(f'{place}; first preview: {watch.preview().split(": ")[1]}, {time.monotonic() - began:.1f} s')
        print('edit,seconds,cells_again')
        time.sleep(given.pause)
        all_seconds = {}
        for edit, changed in versions(document, place, EDITS, given.seed, given.edits):
            seconds, line = save(changed)
            all_seconds[edit] = seconds
            again = re.search(r'\((\d+) baked again\)', line)
            print(f'{edit.__name__},{seconds:.1f},{again.group(1) if again else "all"}', flush=True)
            time.sleep(given.pause)
            save(document)
            time.sleep(given.pause)
        props = [seconds for edit, seconds in all_seconds.items() if edit not in OF_WALLS]
        print(f'median of {len(all_seconds)} edits {statistics.median(all_seconds.values()):.1f} s, of {len(props)} edits of '
              f'props {statistics.median(props):.1f} s')
        watch.process.kill()
        watch.process.wait()


if __name__ == '__main__':
    main()
