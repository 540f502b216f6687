#!/usr/bin/env python3
"""Every command of README.md and docs/ works: blocks of sh are run, page by page, on a small town.

usage: commands.py ROOT BIN    BIN: the folder with the built programs

A block after the comment <!-- not run: REASON --> is not run. Of these, and of commands in inline code, programs, verbs,
options, presets, components and paths have to exist. Bakes are limited to a few cells, verification to a few rays.
Exit code 0: fine, 1: problems, one line each.
"""
import glob
import json
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import words

PAGES = ['README.md', 'docs/**/*.md']
LANGUAGES = {'sh', 'c', 'js', 'jsx', 'cmake', 'json', 'text', 'mermaid'}  # of blocks; one of none could be overlooked
NOT_RUN = re.compile(r'<!--\s*not run:\s*(.+?)\s*-->\s*$')
CELLS, RAYS = '4', '100000'
SECONDS = 300
# Samples whose arguments are files: `--help` would be one.
WITHOUT_OPTIONS = {'sightcell-hello-cull', 'sightcell-engine-bake'}
# Options that inline code names and that are of other programs.
OF_OTHERS = {'--static', '--component', '--preset', '--markdown'}


class Block:
    def __init__(self, page, line, language, reason):
        self.page, self.line, self.language, self.reason = page, line, language, reason
        self.lines = []

    @property
    def place(self):
        return f'{self.page}:{self.line}'


def read_page(root, page):
    """(blocks, inline code with its line, problems)"""
    blocks, inline, problems = [], [], []
    block, fence, previous = None, None, ''
    with open(os.path.join(root, page), encoding='utf-8') as file:
        text = file.read()
    for number, line in enumerate(text.split('\n'), 1):
        mark = words.FENCE.match(line)
        if block is None and mark:
            reason = NOT_RUN.match(previous)
            block, fence = Block(page, number, mark.group(3), reason.group(1) if reason else None), mark.group(2)
            if block.language not in LANGUAGES:
                problems.append(f'{block.place}: a block of "{block.language}": give it one of {sorted(LANGUAGES)}')
            if reason and block.language != 'sh':
                problems.append(f'{block.place}: only sh is run, or not')
        elif block is not None and mark and mark.group(2) == fence and not mark.group(3):
            blocks.append(block)
            block, previous = None, ''
        elif block is not None:
            block.lines.append(line)
        else:
            inline += [(number, code) for code in re.findall(r'`([^`\n]+)`', line)]
            previous = line
    return blocks, inline, problems


class Known:
    """What exists: programs with their verbs and options, presets, options of CMake."""
    shown = {}  # help texts, of all objects

    def __init__(self, root, folder):
        self.root, self.folder = root, folder
        self.programs = {name for name in os.listdir(folder) if re.fullmatch(r'sightcell(-(?!test)\w+)*', name)}
        with open(os.path.join(root, 'CMakePresets.json'), encoding='utf-8') as file:
            presets = json.load(file)
        self.presets = {kind: {p['name'] for p in presets[kind + 'Presets'] if not p.get('hidden')}
                        for kind in ('configure', 'build', 'test')}
        self.cmake = ''
        for pattern in ('CMakeLists.txt', '*/CMakeLists.txt', 'runtime/package/*.cmake', 'bake/package/*.cmake'):
            for path in glob.glob(os.path.join(root, pattern)):
                with open(path, encoding='utf-8') as file:
                    self.cmake += file.read()

    def help(self, program, verb=None):
        if (self.folder, program, verb) not in self.shown:
            text = ''
            # --help-all of sightcell itself has the options of all verbs.
            options = ('--help',) if (program, verb) == ('sightcell', None) else ('--help', '--help-all')
            for option in options if program not in WITHOUT_OPTIONS else ():
                done = subprocess.run([os.path.join(self.folder, program), *([verb] if verb else []), option],
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      text=True, timeout=SECONDS, check=False)
                text += done.stdout
            self.shown[self.folder, program, verb] = text
        return self.shown[self.folder, program, verb]

    def verbs(self):
        listed = re.search(r'^Verbs:\n((?: .*\n)+)', self.help('sightcell'), re.MULTILINE)
        return set(re.findall(r'^  ([a-z]+)\b', listed.group(1), re.MULTILINE)) if listed else set()

    def has_option(self, option, program, verb=None):
        return re.search(re.escape(option) + r'(?![\w-])', self.help(program, verb)) is not None

    def any_has_option(self, option):
        return any(self.has_option(option, 'sightcell', verb) for verb in [None, *self.verbs()]) or any(
            self.has_option(option, program) for program in self.programs - {'sightcell'})


def commands_of(text):
    """The simple commands of shell text, as lists of words. Comments, assignments and redirections go."""
    text = text.replace('\\\n', ' ')
    for line in text.split('\n'):
        lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
        lexer.whitespace_split = True
        lexer.commenters = '#'
        command = []
        for word in lexer:
            if set(word) <= set('();&|'):
                if command:
                    yield command
                command = []
            elif command or not re.match(r'\w+=', word):
                command.append(word)
        if command:
            yield command


def check_command(command, known):
    """What of it does not exist, as texts."""
    program, arguments = command[0], command[1:]
    program = program.removeprefix('build/release/bin/')
    options = [a.split('=')[0] for a in arguments if re.match(r'--\w', a)]
    values = dict(zip(arguments, arguments[1:]))
    if program.startswith('sightcell'):
        if program not in known.programs:
            yield f'there is no program {program}'
            return
        verb = None
        if program == 'sightcell' and arguments and not arguments[0].startswith('-'):
            verb = arguments[0]
            if verb == 'VERB':  # of all of them
                return
            if verb not in known.verbs():
                yield f'sightcell has no verb {verb}'
                return
        for option in options:
            if not known.has_option(option, program, verb):
                yield f'{program} {verb or ""} has no option {option}'
    elif program in ('cmake', 'ctest'):
        kind = 'test' if program == 'ctest' else 'build' if '--build' in arguments else 'configure'
        if '--preset' in values and values['--preset'] not in known.presets[kind]:
            yield f'there is no {kind} preset {values["--preset"]}'
        if '--component' in values and not re.search(rf'COMPONENT {re.escape(values["--component"])}\b', known.cmake):
            yield f'there is no component {values["--component"]}'
        for option in re.findall(r'-D(SIGHTCELL_\w+)', ' '.join(arguments)):
            if not re.search(rf'\b{option}\b', known.cmake):
                yield f'there is no option {option}'
    else:
        there = os.path.exists(os.path.join(known.root, program)) if '/' in program else shutil.which(program)
        if not there and program not in ('cd', 'export'):
            yield f'{program} does not exist'


def check_inline(code, known):
    if re.match(r'(sightcell(-\w+)*|cmake|ctest) ', code):
        for command in commands_of(code):
            yield from check_command(command, known)
    elif re.match(r'(scripts|tests|samples)/[\w./]+', code):
        if not os.path.exists(os.path.join(known.root, code.split()[0])):
            yield f'{code.split()[0]} does not exist'
    elif re.match(r'--\w', code) and not re.search(r'--$', code):
        option = re.match(r'--[\w-]+', code).group(0)
        if option not in OF_OTHERS and not known.any_has_option(option):
            yield f'no program has the option {option}'
    elif re.match(r'-DSIGHTCELL_', code) and not re.search(re.match(r'-D(\w+)', code).group(1) + r'\b', known.cmake):
        yield f'there is no option {code}'


SHIM = '''#!/bin/sh
# {name} as the documents call it, but quick.
case "$1 $*" in
  bake*|cells*)
    case "$*" in *--cell-limit*) ;; *) set -- "$@" --cell-limit {cells} ;; esac
    case "$*" in *--quality*|*--max-pixel-error*) ;; *) set -- "$@" --quality draft ;; esac ;;
  *--rays*|*--from*) ;;
  verify*) set -- "$@" --rays {rays} ;;
esac
exec '{program}' "$@"
'''


def add_lamp_and_door(path):
    """Puts a point light into a .glb, for docs/lights.md, and makes a door of its last object, for docs/baking.md."""
    with open(path, 'rb') as file:
        data = file.read()
    end = 20 + struct.unpack_from('<I', data, 12)[0]
    document = json.loads(data[20:end])
    document.setdefault('extensions', {})['KHR_lights_punctual'] = {'lights': [{'type': 'point', 'range': 20}]}
    door = [node for node in document['nodes'] if 'mesh' in node][-1]
    door.setdefault('extras', {})['sightcell'] = {'group': 'door'}
    document['scenes'][0]['nodes'].append(len(document['nodes']))
    document['nodes'].append({'name': 'lamp', 'translation': [0, 4, 0], 'extensions': {'KHR_lights_punctual': {'light': 0}}})
    text = json.dumps(document).encode()
    text += b' ' * (-len(text) % 4)
    with open(path, 'wb') as file:
        file.write(struct.pack('<4s2I', b'glTF', 2, 20 + len(text) + len(data) - end))
        file.write(struct.pack('<2I', len(text), 0x4E4F534A) + text + data[end:])


def prepare(root, folder, work):
    """A folder for pages: programs, and a bake that all pages share."""
    programs = os.path.join(work, 'bin')
    os.makedirs(programs)
    for name in sorted(os.listdir(folder)):
        if name == 'sightcell':
            with open(os.path.join(programs, name), 'w', encoding='utf-8') as file:
                file.write(SHIM.format(name=name, cells=CELLS, rays=RAYS, program=os.path.join(folder, name)))
            os.chmod(os.path.join(programs, name), 0o755)
        elif name.startswith('sightcell-'):
            os.symlink(os.path.join(folder, name), os.path.join(programs, name))
    shared = os.path.join(work, 'shared')
    os.makedirs(shared)
    for line in ('sightcell-city --polygons 3000 --seed 1 --out level.glb --cells cells.json',
                 'sightcell-city --polygons 600 --seed 1 --out A.glb', 'sightcell-city --polygons 800 --seed 2 --out B.glb',
                 'sightcell bake level.glb -o level.pvs'):
        subprocess.run(line.split(), cwd=shared, env=environment(work), stdin=subprocess.DEVNULL, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=SECONDS)
        if '--out level.glb' in line:
            add_lamp_and_door(os.path.join(shared, 'level.glb'))
    with open(os.path.join(shared, 'misses.json'), 'w', encoding='utf-8') as file:
        json.dump({'misses': [{'eye': [1.0, 1.7, 2.0], 'polygon': 17}]}, file)
    with open(os.path.join(shared, 'path.json'), 'w', encoding='utf-8') as file:
        json.dump({'path': [[0.0, 1.7, 0.0], [4.0, 1.7, 0.0]]}, file)
    os.makedirs(os.path.join(shared, 'build/release'))
    os.symlink(programs, os.path.join(shared, 'build/release/bin'))
    for name in ('scripts', 'samples', 'tests'):
        os.symlink(os.path.join(root, name), os.path.join(shared, name))
    return shared


def environment(work):
    return {**os.environ, 'PATH': os.path.join(work, 'bin') + os.pathsep + os.environ['PATH'], 'HOME': work,
            'LC_ALL': 'C.UTF-8', 'TMPDIR': work}


def run_page(blocks, shared, work):
    """The first problem of a page's blocks, run one after the other in one shell."""
    folder = tempfile.mkdtemp(dir=work)
    shutil.copytree(shared, folder, symlinks=True, dirs_exist_ok=True)
    at = os.path.join(work, 'at')
    script = ['set -euo pipefail']
    for block in blocks:
        script += [f'echo {block.place} >{shlex.quote(at)}', *block.lines]
    done = subprocess.run(['bash', '-c', '\n'.join(script)], cwd=folder, env=environment(work),
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors='replace', timeout=SECONDS, check=False)
    if done.returncode == 0:
        return []
    with open(at, encoding='utf-8') as file:
        place = file.read().strip()
    return [f'{place}: exit code {done.returncode}: {" / ".join(done.stdout.splitlines()[-4:])}']


def check(root, folder):
    known = Known(root, folder)
    problems, runs = [], []
    pages = [os.path.relpath(p, root) for place in PAGES for p in sorted(glob.glob(os.path.join(root, place), recursive=True))]
    for page in pages:
        blocks, inline, more = read_page(root, page)
        problems += more
        for block in blocks:
            if block.language == 'sh':
                for command in commands_of('\n'.join(block.lines)):
                    problems += [f'{block.place}: {text}' for text in check_command(command, known)]
            elif block.language == 'text' and any(re.match(r'[$ ]*sightcell[\w-]* ', l) for l in block.lines):
                problems.append(f'{block.place}: a command in a block of text')
        for number, code in inline:
            problems += [f'{page}:{number}: {text}' for text in check_inline(code, known)]
        runs.append([block for block in blocks if block.language == 'sh' and block.reason is None])
    if not any(runs):
        return problems + ['no page has a command to run']
    with tempfile.TemporaryDirectory(prefix='sightcell-docs-') as work:
        shared = prepare(root, folder, work)
        for blocks in filter(None, runs):
            problems += run_page(blocks, shared, work)
    return problems


def main():
    problems = check(sys.argv[1], os.path.abspath(sys.argv[2]))
    print('\n'.join(problems) or 'commands: fine')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
