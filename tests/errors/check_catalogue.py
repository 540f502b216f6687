#!/usr/bin/env python3
"""The page bake/ERRORS.md has exactly the errors that the sources of bake/ have, and each is provoked by a test.

usage: check_catalogue.py ROOT

How ids are found: every text in the sources that looks like one ("room.what-it-is") or ends in one in brackets, so that
no way of throwing escapes. Beside that every sightcell::error that is made has to be given a literal id, or the `id` of
a function that was. Exit code 0: fine, 1: problems, one line each, 2: nothing to look at.
"""
import os
import re
import sys

sys.dont_write_bytecode = True
import cases  # noqa: E402

PAGE = 'bake/ERRORS.md'
CODES = {'failed': 1, 'wrong_use': 2, 'bad_input': 4}
SUFFIXES = ('.h', '.cpp')
ID = re.compile(r'[a-z]+\.[a-z]+(?:-[a-z]+)*')
TEXT = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/', re.DOTALL)
IN_BRACKETS = re.compile(r'\[(' + ID.pattern + r')\](?:\\n)?$')
MADE = re.compile(r'(?<![:\w])(?:sightcell::)?error\(\s*(?:sightcell::)?error_kind::(\w+)\s*,\s*([^,]*),')
# What looks like an id and is none: subjects of messages, names of files.
NO_IDS = {'settings.cells', 'scene.front', 'tileset.json'}
ROW = re.compile(r'^\| `([^`]+)` \| ([0-9, ]+) \| (.+?) \| (.+?) \|$')


def sources(root):
    """(path, text without comments and includes) of every file of bake/."""
    for folder, _, names in os.walk(os.path.join(root, 'bake')):
        for name in sorted(names):
            if not name.endswith(SUFFIXES):
                continue
            path = os.path.join(folder, name)
            with open(path, encoding='utf-8') as file:
                text = file.read()
            text = re.sub(r'^\s*#\s*include.*$', '', text, flags=re.MULTILINE)
            # Comments go, texts that contain // stay.
            text = re.sub(TEXT.pattern + '|' + COMMENT.pattern,
                          lambda m: m.group(0) if m.group(0).startswith('"') else '', text, flags=re.DOTALL)
            yield os.path.relpath(path, root), text


def ids_of(text):
    for literal in TEXT.findall(text):
        if ID.fullmatch(literal) and not literal.endswith(SUFFIXES) and literal not in NO_IDS:
            yield literal
        found = IN_BRACKETS.search(literal)
        if found:
            yield found.group(1)


def thrown(root):
    """id -> the files that have it; problems."""
    ids, problems, known_codes = {}, [], {}
    for path, text in sources(root):
        for identifier in ids_of(text):
            ids.setdefault(identifier, set()).add(path)
        for kind, given in MADE.findall(text):
            literals = [i for i in TEXT.findall(given) if ID.fullmatch(i)]
            if not literals and given.strip() != 'id':
                problems.append(f'{path}: an error is made with the id {given.strip()}: give it a literal')
            for identifier in literals:
                known_codes.setdefault(identifier, set()).add(CODES[kind])
    return ids, known_codes, problems


def page(root):
    """id -> exit codes; problems."""
    entries, problems = {}, []
    with open(os.path.join(root, PAGE), encoding='utf-8') as file:
        for number, line in enumerate(file, 1):
            if not line.startswith('| `'):
                continue
            row = ROW.match(line.rstrip('\n'))
            if not row:
                problems.append(f'{PAGE}:{number}: not a row of id, exit code, meaning and remedy')
            elif row.group(1) in entries:
                problems.append(f'{PAGE}:{number}: {row.group(1)} has a second entry')
            else:
                entries[row.group(1)] = {int(code) for code in row.group(2).split(',')}
    if list(entries) != sorted(entries):
        problems.append(f'{PAGE}: the entries are not in alphabetical order')
    return entries, problems


def check(root, provoked, unit_tests):
    ids, known_codes, problems = thrown(root)
    if not ids:
        return None
    entries, more = page(root)
    problems += more
    for identifier in sorted(ids.keys() - entries.keys()):
        problems.append(f'{identifier} ({", ".join(sorted(ids[identifier]))}) has no entry in {PAGE}')
    for identifier in sorted(entries.keys() - ids.keys()):
        problems.append(f'{identifier} of {PAGE} is in no source of bake/')
    for identifier, codes in sorted(known_codes.items()):
        if identifier in entries and not codes <= entries[identifier]:
            problems.append(f'{identifier}: the sources say exit code {sorted(codes)}, {PAGE} {sorted(entries[identifier])}')
    codes_by_case = {}
    for identifier, code, _ in provoked:
        codes_by_case.setdefault(identifier, set()).add(code)
    for identifier in sorted(ids.keys() - codes_by_case.keys() - unit_tests.keys()):
        problems.append(f'{identifier} is provoked by nothing: add it to tests/errors/cases.py')
    for identifier in sorted((codes_by_case.keys() | unit_tests.keys()) - ids.keys()):
        problems.append(f'{identifier} of tests/errors/cases.py is in no source of bake/')
    for identifier, codes in sorted(codes_by_case.items()):
        if identifier not in unit_tests and entries.get(identifier, codes) != codes:
            problems.append(f'{identifier}: {PAGE} says exit code {sorted(entries[identifier])}, provoked are {sorted(codes)}')
    for identifier, test in sorted(unit_tests.items()):
        path = os.path.join(root, test)
        if not os.path.isfile(path):
            problems.append(f'{identifier}: {test} does not exist')
            continue
        with open(path, encoding='utf-8') as file:
            if not re.search(rf'["\[]{re.escape(identifier)}["\]]', file.read()):
                problems.append(f'{identifier}: {test} does not mention it')
    return problems


def main():
    problems = check(sys.argv[1], cases.CASES, cases.UNIT_TESTS)
    if problems is None:
        print('no error ids found: is this the root of the sources?')
        return 2
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
