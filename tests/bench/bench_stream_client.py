#!/usr/bin/python3
"""What sightcell-stream-client measures from random poses over a slow connection (slow_link.py).

usage: bench_stream_client.py --bin FOLDER --server PORT [--poses N] [--seed N] [--rate MBIT] [--round-trip MS]
                              [--client OPTION ...] NAME=SITE ...

--server: the port of a web server on this machine that sends each SITE as /NAME/. A pose is a random point of a random
view cell, with a random heading. One client after the other starts with nothing. Prints a row per site: the median and
the largest of seconds and bytes until 99 and 99.9 % of the weight of the cell are decoded, and until the cell is complete
with its images. Bytes are all files that have arrived by then, with front, cell chunks and headers.
"""
import argparse
import json
import math
import os
import random
import statistics
import subprocess
import sys
import time

sys.dont_write_bytecode = True  # nothing is written into the sources
sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'stream')]
from streamed_scene import open_site  # noqa: E402


def poses(site, count, seed):
    """Positions, and points in the direction of the view."""
    one = random.Random(seed)
    cells = site.cells()
    for number in one.choices(sorted(cells), k=count):
        low, high = cells[number].box.astype(float)
        eye = [a + (b - a) * one.random() for a, b in zip(low, high)]
        heading = one.uniform(0, 2 * math.pi)
        yield eye, [eye[0] + math.cos(heading), eye[1], eye[2] + math.sin(heading)]


def joined(numbers):
    return ','.join(f'{number:.7g}' for number in numbers)


def run(program, url, eye, look, more):
    done = subprocess.run([program, url, f'--eye={joined(eye)}', f'--look={joined(look)}', '--json', '--no-draw', *more],
                          stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout)


def level(result, percent):
    return next(level for level in result['levels'] if level['percent'] == percent)


def row(name, results):
    columns = [[level(r, percent)[key] for r in results] for percent in (99, 99.9) for key in ('seconds', 'bytes')]
    columns += [[r['first_cell_complete'] for r in results], [r['bytes'] for r in results]]
    parts = [name, str(len(results))]
    for i, column in enumerate(columns):
        scale, form = (1000, '{:.0f} KB') if i % 2 else (1, '{:.2f} s')
        parts.append(form.format(statistics.median(column) / scale) + ' / ' + form.format(max(column) / scale))
    return ' | '.join(parts)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--bin', required=True)
    parser.add_argument('--server', type=int, required=True)
    parser.add_argument('--poses', type=int, default=10)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--rate', default='10')
    parser.add_argument('--round-trip', default='40')
    parser.add_argument('--port', type=int, default=8790, help='of the slow connection')
    parser.add_argument('--scheme', default='http')
    parser.add_argument('--client', action='append', default=[], help='an option of the client')
    parser.add_argument('sites', nargs='+')
    arguments = parser.parse_args()
    link = subprocess.Popen([sys.executable, os.path.join(os.path.dirname(os.path.abspath(__file__)), 'slow_link.py'),
                             str(arguments.port), str(arguments.server), '--rate', arguments.rate, '--round-trip',
                             arguments.round_trip])
    try:
        time.sleep(0.5)
        print('scene | poses | 99 %: median / most | | 99.9 % | | complete, with images |')
        for site in arguments.sites:
            name, folder = site.split('=', 1)
            results = [run(os.path.join(arguments.bin, 'sightcell-stream-client'),
                           f'{arguments.scheme}://127.0.0.1:{arguments.port}/{name}/', eye, look, arguments.client)
                       for eye, look in poses(open_site(os.path.abspath(folder)), arguments.poses, arguments.seed)]
            print(row(name, results), flush=True)
    finally:
        link.terminate()
        link.wait()


if __name__ == '__main__':
    main()
