#!/usr/bin/env python3
"""Puts the page together with what it loads, as a folder that any static web server can send: the page, the npm package
sightcell, three.js, three-mesh-bvh, a scene and its .pvs file.

usage: make_site.py OUT --package DIR --packages NODE_MODULES --scene FILE.glb --sets FILE.pvs --start X,Y,Z
                    [--heading RADIANS] [--three DIR]
--start: a point above the floor where the walk begins, in meters
--three: another release of three.js than that of NODE_MODULES
"""
import argparse
import json
import os
import re
import shutil

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'page')
IMPORTS = re.compile(r"(?:^|\n)\s*(?:import|export)\b[^;'\"]*?\bfrom\s*['\"]([^'\"]+)['\"]")
PACKAGES = {'three': ['build/three.module.js'], 'three-mesh-bvh': ['build/index.module.js']}


def copy_with_imports(root, name, out, done):
    """Copies a script of a package, and those of the same package that it imports."""
    if name in done:
        return
    done.add(name)
    source = os.path.join(root, name)
    target = os.path.join(out, name)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    shutil.copy(source, target)
    with open(source, encoding='utf-8') as file:
        for imported in IMPORTS.findall(file.read()):
            if imported.startswith('.'):
                copy_with_imports(root, os.path.normpath(os.path.join(os.path.dirname(name), imported)), out, done)


def addons_of_page():
    """The files of three/examples/jsm that the page imports."""
    for name in sorted(os.listdir(PAGE)):
        if name.endswith('.js'):
            with open(os.path.join(PAGE, name), encoding='utf-8') as file:
                for imported in IMPORTS.findall(file.read()):
                    if imported.startswith('three/addons/'):
                        yield imported.replace('three/addons/', 'examples/jsm/')


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split('usage: ')[1])
    parser.add_argument('out')
    for name in ('package', 'packages', 'scene', 'sets', 'start'):
        parser.add_argument(f'--{name}', required=True)
    parser.add_argument('--heading', type=float, default=0)
    parser.add_argument('--three')
    options = parser.parse_args()
    shutil.rmtree(options.out, ignore_errors=True)
    shutil.copytree(PAGE, options.out)
    shutil.copytree(options.package, os.path.join(options.out, 'sightcell'))
    for package, scripts in PACKAGES.items():
        root = os.path.join(options.packages, package)
        if package == 'three' and options.three:
            root = options.three
        done = set()
        for script in scripts + (list(addons_of_page()) if package == 'three' else []):
            copy_with_imports(root, script, os.path.join(options.out, package), done)
        shutil.copy(os.path.join(root, 'LICENSE'), os.path.join(options.out, package))
    site = {'start': [float(end) for end in options.start.split(',')], 'heading': options.heading}
    for key, path in (('scene', options.scene), ('sets', options.sets)):
        site[key] = os.path.basename(path)
        shutil.copy(path, options.out)
    with open(os.path.join(options.out, 'site.json'), 'w', encoding='utf-8') as file:
        json.dump(site, file)


if __name__ == '__main__':
    main()
