#!/usr/bin/env python3
"""Writes layout.js: where the members of the structs of sightcell.h are in the memory of the module, and the values of
its constants. The compiler that builds the module is asked, so that no number is written by hand.

usage: make_layout.py CLANG TARGET HEADER OUT.js
"""
import json
import re
import subprocess
import sys

NUMBERS = {'uint8_t': 'u8', 'uint32_t': 'u32', 'uint64_t': 'u64', 'float': 'f32', 'double': 'f64'}
DUMP = re.compile(r'\*\*\* Dumping AST Record Layout\n *0 \| struct sightcell_(\w+)\n(.*?)\| \[sizeof=(\d+)', re.DOTALL)
MEMBER = re.compile(r'^ *(\d+) \|   (\S.*?) (\w+)$', re.MULTILINE)
DEFINED = re.compile(r'^#define SIGHTCELL_(\w+) (0[xX][0-9a-fA-F]+|\d+)[uU]?$', re.MULTILINE)


def ask(command, *options):
    return subprocess.run([*command, *options], check=True, capture_output=True, text=True).stdout


def type_of(text):
    """The kind of a member's numbers, and how many it has."""
    if '*' in text:
        return 'u32', 1  # an address, or a function's number in the table
    found = re.fullmatch(r'(\w+)(?:\[(\d+)\])?', text)
    if found is None or found.group(1) not in NUMBERS:
        raise SystemExit(f'make_layout.py: no kind of number for the type {text}')
    return NUMBERS[found.group(1)], int(found.group(2) or 1)


def structs_of(dump):
    structs = {}
    for name, body, size in DUMP.findall(dump):
        members = {}
        for at, text, member in MEMBER.findall(body):
            kind, count = type_of(text)
            members[member] = {'at': int(at), 'kind': kind, **({'count': count} if count > 1 else {})}
        structs[name] = {'size': int(size), 'members': members}
    return structs


def value_of(node):
    """The value of an enumerator, which the header states: below a conversion where it is unsigned."""
    return int(node['value']) if node['kind'] == 'ConstantExpr' else value_of(node['inner'][0])


def enumerators(node):
    if node.get('kind') == 'EnumConstantDecl' and node['name'].startswith('SIGHTCELL_'):
        yield node['name'].removeprefix('SIGHTCELL_'), value_of(node['inner'][0])
    for child in node.get('inner', []):
        yield from enumerators(child)


def as_script(value):
    """JavaScript without quotes around names: the package is to be small."""
    return re.sub(r'"(\w+)":', r'\1:', json.dumps(value, separators=(',', ':'))).replace('"', "'")


def in_lines(name, table):
    lines = ',\n'.join(f'  {key}: {as_script(value)}' for key, value in table.items())
    return f'export const {name} = {{\n{lines},\n}};\n'


def main():
    clang, target, header, out = sys.argv[1:]
    command = [clang, f'--target={target}', '-std=c11', '-x', 'c', header]
    structs = structs_of(ask(command, '-fsyntax-only', '-Xclang', '-fdump-record-layouts-complete'))
    constants = {name: int(value, 0) for name, value in DEFINED.findall(ask(command, '-E', '-dM'))}
    constants.update(enumerators(json.loads(ask(command, '-fsyntax-only', '-Xclang', '-ast-dump=json'))))
    if not structs or 'OK' not in constants:
        raise SystemExit(f'make_layout.py: {clang} printed no struct or no constant of {header}')
    with open(out, 'w', encoding='utf-8') as file:
        file.write('// Made by make_layout.py from sightcell.h: offsets and sizes in bytes, and the values of constants.\n')
        file.write(in_lines('constants', constants))
        file.write(in_lines('structs', structs))


if __name__ == '__main__':
    main()
