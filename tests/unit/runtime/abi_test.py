#!/usr/bin/env python3
"""The C ABI is what abi.txt records: every constant, struct, field, function and exported symbol of some headers.

usage: abi_test.py COMPILER HEADERS ABI.txt [NM LIBRARY.so]    exit code 1 where something differs from the record
       abi_test.py COMPILER HEADERS ABI.txt --record           writes the record anew, on a machine with 64-bit pointers
COMPILER may have options: "cc -I folder". HEADERS: the headers of one library, with commas between them.

The header is parsed for the names and types that it declares. The compiler checks the recorded numbers and types by
_Static_assert: no program runs, so a cross compiler will do. Lines may be added to the record; a line of a released
version never changes.
"""
import os
import re
import subprocess
import sys
import tempfile


def abstract(declaration):
    """The type and the name that a declaration such as `const float eye[3]` has: ('const float[3]', 'eye')."""
    text = ' '.join(declaration.split())
    function = re.fullmatch(r'(.+?) ?\(\*(\w+)\)\((.*)\)', text)
    if function:
        return f'{function[1]} (*)({parameter_types(function[3])})', function[2]
    kind, name, extent = re.fullmatch(r'(.*?) ?(\w+)((?:\[\w+\])?)', text).groups()
    return kind + extent, name


def parameter_types(parameters):
    if parameters.strip() == 'void':
        return 'void'
    return ', '.join(re.sub(r'\[\w*\]$', '*', abstract(p)[0]) for p in parameters.split(','))


def fields_of(body):
    """(type, name) of each field: `float min[3], max[3];` has two, as has `uint32_t first, count;`."""
    for declaration in filter(None, map(str.strip, body.split(';'))):
        # The parameters of a function pointer have commas too.
        first, *others = [declaration] if '(' in declaration else declaration.split(',')
        yield abstract(first)
        base = abstract(first)[0].split('[')[0]
        yield from (abstract(f'{base} {other}') for other in others)


def declared(headers):
    """All that the headers declare: {line of the record without its number: the number as a C expression, or None}."""
    found = {}
    for header in headers.split(','):
        found |= declared_in(header)
    return found


def declared_in(header):
    with open(header, encoding='utf-8') as stream:
        text = re.sub(r'/\*.*?\*/', ' ', stream.read(), flags=re.DOTALL)
    found = {}

    def take(pattern, lines_of, flags=0):
        nonlocal text
        for match in re.finditer(pattern, text, flags):
            found.update(lines_of(match))
        text = re.sub(pattern, '', text, flags=flags)

    def enum_lines(match):
        sizes = {f'enum {match[2]}': f'sizeof({match[2]})'} if match[2] else {}
        names = [entry.split('=')[0].strip() for entry in match[1].split(',')]
        return sizes | {f'constant {name}': name for name in names}

    def struct_lines(match):
        name = match[1]
        return {f'struct {name}': f'sizeof({name})'} | {
            f'field {name}.{field}: {kind}': f'offsetof({name}, {field})' for kind, field in fields_of(match[2])}

    take(r'^#define (SIGHTCELL_\w+) +(?:0x[0-9A-Fa-f]+|\d+)u?$', lambda m: {f'constant {m[1]}': m[1]}, re.MULTILINE)
    take(r'^#.*$', lambda m: {}, re.MULTILINE)
    take(r'(?:typedef )?enum\s*\w*\s*\{([^}]*)\}\s*(\w*)\s*;', enum_lines)
    take(r'typedef struct (\w+)\s*\{([^}]*)\}\s*\1\s*;', struct_lines)
    take(r'typedef struct (\w+) \1;', lambda m: {f'opaque {m[1]}': None})
    take(r'SIGHTCELL_API\s+([\w\s*]+?)\s*\b(sightcell_\w+)\(([^;]*)\);',
         lambda m: {f'function {m[2]}: {m[1]} ({parameter_types(m[3])})': None})
    rest = text.replace('extern "C" {', '').replace('}', '').strip()
    if rest:
        sys.exit(f'{header}: neither constant, enum, struct nor function: {rest[:300]}')
    return found


def compile_c(compiler, headers, source, *options):
    """What the compiler prints about a program that includes the headers: nothing where it is right."""
    command = [*compiler.split(' '), '-std=c11', '-DSIGHTCELL_STATIC', *options, '-x', 'c', '-']
    for header in headers.split(','):
        folder, name = os.path.split(os.path.abspath(header))
        command[1:1] = ['-I', os.path.dirname(folder)]
        source = f'#include <sightcell/{name}>\n{source}'
    source = f'#include <stdio.h>\n{source}'
    done = subprocess.run(command, check=False, capture_output=True, text=True, input=source)
    return done.stderr if done.returncode != 0 else ''


def record(compiler, header, path):
    lines = []
    for line, number in declared(header).items():
        text = line if number is None else f'{line} = '
        value = '' if number is None else f' printf("%llu", (unsigned long long)({number}));'
        lines.append(f'  fputs("{text}", stdout);{value} puts("");')
    source = 'int main(void) {\n' + '\n'.join(lines) + '\n  return 0;\n}\n'
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, 'abi')
        problem = compile_c(compiler, header, source, '-o', program)
        if problem:
            sys.exit(problem)
        with open(path, 'w', encoding='utf-8') as stream:
            subprocess.run([program], check=True, stdout=stream)


def assertion(line, number, expression):
    """C text that compiles only where a recorded line holds."""
    typed = re.fullmatch(r'(function|field) ([\w.]+): (.+)', line)
    checks = [] if number is None else [f'({expression}) == {number}']
    if typed and typed[1] == 'function':
        result, parameters = re.fullmatch(r'(.+?) \((.*)\)', typed[3]).groups()
        checks.append(f'_Generic(&{typed[2]}, {result} (*)({parameters}): 1, default: 0)')
    elif typed:
        owner, field = typed[2].split('.')
        checks.append(f'_Generic(&(({owner}*)0)->{field}, __typeof__({typed[3]})*: 1, default: 0)')
    return ''.join(f'_Static_assert({check}, "{line}");\n' for check in checks)


def check(compiler, header, path):
    with open(path, encoding='utf-8') as stream:
        recorded = dict((line.split(' = ') + [None])[:2] for line in stream.read().splitlines())
    found = declared(header)
    problems = [f'recorded, but not in the header: {line}' for line in recorded if line not in found]
    problems += [f'in the header, but not recorded: {line}' for line in found if line not in recorded]
    assertions = [assertion(line, number, found[line]) for line, number in recorded.items() if line in found]
    return problems + compile_c(compiler, header, ''.join(assertions), '-fsyntax-only').splitlines(), recorded


def exported(nm, library):
    output = subprocess.run([nm, '-D', '--defined-only', library], check=True, capture_output=True, text=True).stdout
    return {line.split()[-1].split('@')[0] for line in output.splitlines() if line.strip()}


def main():
    compiler, header, path, *rest = sys.argv[1:]
    if rest == ['--record']:
        return record(compiler, header, path)
    problems, recorded = check(compiler, header, path)
    functions = {line.split()[1].rstrip(':') for line in recorded if line.startswith('function ')}
    if not functions:
        problems.append(f'{path} records no function')
    if rest:
        symbols = exported(*rest)
        problems += [f'not exported: {name}' for name in sorted(functions - symbols)]
        problems += [f'exported, but not recorded: {name}' for name in sorted(symbols - functions)]
    if problems:
        sys.exit('\n'.join(problems))
    print(f'{len(recorded)} lines, {len(functions)} functions')


if __name__ == '__main__':
    main()
