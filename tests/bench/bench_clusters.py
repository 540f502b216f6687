#!/usr/bin/env python3
"""Files of clusters against files of polygons.

usage: bench_clusters.py --bin FOLDER [--out FILE.json] SCENE FILE.pvs [SCENE FILE.pvs ...]

FOLDER has sightcell and bench_clusters; each FILE.pvs has sets of polygons of its SCENE. Recodes it into
clusters and prints, per scene: bytes of both files and of their rows, clusters and polygons per set, polygons drawn per
polygon of the set, microseconds per change of cell for the row of bits of both, and the CPU seconds of the recode.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return done.stdout.decode()


def info(program, file):
    found = json.loads(run(program, 'info', file, '--json'))
    sections = {section['name']: section['size'] for section in found['sections']}
    return found, sections


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def row_of(folder, scene, polygons, work):
    program, bench = (os.path.join(folder, name) for name in ('sightcell', 'bench_clusters'))
    clusters = os.path.join(work, 'clusters.pvs')
    before = cpu_seconds()
    run(program, 'recode', polygons, '--granularity', 'cluster', '--scene', scene, '-o', clusters)
    recode = cpu_seconds() - before
    (old, old_sections), (new, new_sections) = info(program, polygons), info(program, clusters)
    of_host = json.loads(run(bench, scene, polygons))
    of_file = json.loads(run(bench, scene, clusters))
    return {
        'scene': os.path.splitext(os.path.basename(scene))[0],
        'cells': new['cells'],
        'polygons': new['polygons'],
        'clusters': new['clusters'],
        'bytes_of_polygons': old['bytes'],
        'bytes_of_clusters': new['bytes'],
        'bytes_percent': round(100 * new['bytes'] / old['bytes'], 1),
        'rows_of_polygons': old_sections['rows'],
        'rows_of_clusters': new_sections['rows'],
        'orders_of_polygons': old_sections['orders'],
        'orders_of_clusters': new_sections['orders'] + new_sections['clusters'],
        'clusters_per_set': round(new['clusters_per_cell'], 1),
        'drawn_by_set': round(new['visible_set_percent'] / old['visible_set_percent'], 2),
        'bits_us_from_polygons': round(of_host['bits_us'], 2),
        'bits_us_from_clusters': round(of_file['bits_us'], 2),
        'most_bits_us_from_clusters': round(of_file['most_bits_us'], 2),
        'move_us_from_polygons': round(of_host['move_us'], 2),
        'move_us_from_clusters': round(of_file['move_us'], 2),
        'recode_cpu_s': round(recode, 1),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--bin', required=True)
    parser.add_argument('--out')
    parser.add_argument('pairs', nargs='+', metavar='SCENE FILE.pvs')
    options = parser.parse_args()
    if len(options.pairs) % 2:
        parser.error('each SCENE needs a FILE.pvs')
    rows = []
    with tempfile.TemporaryDirectory() as work:
        for scene, file in zip(options.pairs[::2], options.pairs[1::2]):
            rows.append(row_of(options.bin, scene, file, work))
            for key, value in rows[-1].items():
                print(f'{key:28} {value}')
            print(flush=True)
    if options.out:
        with open(options.out, 'w', encoding='utf-8') as out:
            json.dump(rows, out, indent=1)
            out.write('\n')
    return 0


if __name__ == '__main__':
    sys.exit(main())
