#!/usr/bin/env python3
"""No text for users contains a phrase of the column "not" of docs/glossary.md.

usage: words.py ROOT [PROGRAM]    PROGRAM: a built `sightcell`; its help texts are checked too

A phrase is found across line breaks and in any case. Code is skipped: inline code, and fenced blocks except for their
comments; of C and C++ headers only comments are read. Exit code 0: fine, 1: problems, one line each.
"""
import fnmatch
import glob
import os
import re
import subprocess
import sys

GLOSSARY = 'docs/glossary.md'

# Where the phrases must not be. To check a place, add it; the kind is markdown or header.
PLACES = [
    ('bake/*/include/**/*.h', 'header'),
    ('bake/include/**/*.h', 'header'),
    ('README.md', 'markdown'),
    ('CHANGELOG.md', 'markdown'),
    ('CONTRIBUTING.md', 'markdown'),
    ('THIRD_PARTY.md', 'markdown'),
    ('docs/**/*.md', 'markdown'),
    ('bake/ERRORS.md', 'markdown'),
    ('BENCHMARKS.md', 'markdown'),
    ('tests/bench/results/TABLES.md', 'markdown'),
    ('bake/README.md', 'markdown'),
    ('bake/*/README.md', 'markdown'),
    ('format/*.md', 'markdown'),
    ('format/include/sightcell/format/*.h', 'header'),
    ('runtime/README.md', 'markdown'),
    ('runtime/include/sightcell/*.h*', 'header'),
    ('runtime/csharp/README.md', 'markdown'),
    ('runtime/csharp/package/README.md', 'markdown'),
    ('runtime/csharp/package/Runtime/*.cs', 'header'),
    ('runtime/web/npm/README.md', 'markdown'),
    ('runtime/web/npm/*.d.ts', 'header'),
    ('samples/*/README.md', 'markdown'),
    ('shaders/README.md', 'markdown'),
    ('samples/hello_cull/*.c', 'header'),
]
# Verbs of the program whose `--help` is checked; '' is the program's own.
HELP = ['', 'bake', 'verify', 'report', 'view', 'info', 'diff', 'patch', 'recode', 'migrate', 'pack', 'strip', 'merge', 'cells', 'samplers']

# The few legitimate uses: (pattern of places, phrase, regular expression for the text around it: 60 characters on each
# side, in one line). An entry that no text needs any more is a problem too.
ALLOWED = [
    ('*', 'hides', r'\b([Ss]hows (and|or)|host|that|shown: 0) hides\b'),  # a named group
    ('samples/city/README.md', 'lanes', r'.'),  # streets
    ('docs/*', 'lanes', r'\bSIMD lanes\b|\blanes of SIMD registers\b'),
]

FENCE = re.compile(r'^(\s*)(```+|~~~+)\s*(\w*)')
HASH_COMMENTS = {'sh', 'cmake', 'python', 'yaml', 'console'}
SLASH_COMMENTS = {'c', 'cpp', 'js', 'glsl'}


class Phrase:
    """One entry of the column "not". A hyphen at its end lets the last word go on."""

    def __init__(self, text):
        self.text = text
        words = text.rstrip('-').split()
        gap = r'(?:[ \t]*\n[ \t]*|[ \t]+)'
        end = r'\w*' if text.endswith('-') else r'(?![\w-])'
        self.pattern = re.compile(r'(?<![\w-])' + gap.join(map(re.escape, words)) + end, re.IGNORECASE)


def rows_of_words(text):
    """Cells of each row of the tables of `text` whose header is say | not | notes; the line's number first."""
    inside = False
    for number, line in enumerate(text.split('\n'), 1):
        cells = [cell.strip() for cell in line.strip().strip('|').split('|')] if line.startswith('|') else []
        if cells[:3] == ['say', 'not', 'notes']:
            inside = True
        elif not cells:
            inside = False
        elif inside and not set(''.join(cells)) <= set('-: '):
            yield number, cells


def phrases(root):
    with open(os.path.join(root, GLOSSARY), encoding='utf-8') as file:
        text = file.read()
    return [Phrase(entry) for _, cells in rows_of_words(text) for entry in re.findall(r'["`]([^"`]+)["`]', cells[1])]


def comment_of(line, language):
    """What of a line of code is comment."""
    if language in HASH_COMMENTS:
        found = re.search(r'(?:^|\s)#(.*)$', line)
        return found.group(1) if found else ''
    if language in SLASH_COMMENTS:
        return ' '.join(a or b for a, b in re.findall(r'/\*(.*?)\*/|//(.*)$', line))
    return ''


def prose_of_markdown(text):
    """The text, line for line, without code, addresses and HTML comments."""
    text = re.sub(r'<!--.*?-->', lambda found: '\n' * found.group(0).count('\n'), text, flags=re.DOTALL)
    lines, fence, language = [], None, ''
    for line in text.split('\n'):
        mark = FENCE.match(line)
        if fence is None and mark:
            fence, language = mark.group(2), mark.group(3)
            lines.append('')
        elif fence is not None:
            ends = mark is not None and mark.group(2).startswith(fence) and not mark.group(3)
            lines.append('' if ends else comment_of(line, language))
            if ends:
                fence = None
        else:
            lines.append(line.lstrip('> '))
    text = '\n'.join(lines)
    text = re.sub(r'(`+)(?!`).+?(?<!`)\1(?!`)', lambda found: ' ' * 3 + '\n' * found.group(0).count('\n'), text,
                  flags=re.DOTALL)
    text = re.sub(r'\]\([^)\s]*\)', ']', text)
    return re.sub(r'[*_]{2,}', '', text)


def prose_of_header(text):
    """The comments of C or C++, line for line."""
    prose = []
    for found in re.finditer(r'"(?:[^"\\\n]|\\.)*"|//[^\n]*|/\*.*?\*/|\n|[^"/\n]+|.', text, re.DOTALL):
        token = found.group(0)
        if token.startswith('/*'):
            prose.append(re.sub(r'\n[ \t]*\*?', '\n', token[2:-2]))
        elif token.startswith('//'):
            prose.append(token.lstrip('/'))
        else:
            prose.append('\n' * token.count('\n') or ' ')
    return re.sub(r'`[^`\n]*`', '   ', ''.join(prose))


def prose_of_glossary(text):
    """Of the table of words, what it forbids is not read."""
    lines = prose_of_markdown(text).split('\n')
    for number, cells in rows_of_words(text):
        lines[number - 1] = ' | '.join(cell for column, cell in enumerate(cells) if column != 1)
    return '\n'.join(lines)


def texts(root, program):
    """(name, prose) of every place."""
    for place, kind in PLACES:
        found = sorted(glob.glob(os.path.join(root, place), recursive=True))
        if not found:
            yield place, None
        for path in found:
            name = os.path.relpath(path, root)
            with open(path, encoding='utf-8') as file:
                text = file.read()
            if name == GLOSSARY:
                yield name, prose_of_glossary(text)
            else:
                yield name, prose_of_markdown(text) if kind == 'markdown' else prose_of_header(text)
    for verb in HELP if program else []:
        for option in ('--help', '--help-all'):
            shown = subprocess.run([program, *verb.split(), option], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, check=False)
            yield f'sightcell {verb} {option}'.replace('  ', ' '), shown.stdout if shown.returncode == 0 else None


def around(prose, start, end):
    return ' '.join(prose[max(0, start - 60):end + 60].split())


def check(root, program=None, allowed=None):
    """Problems, one line each."""
    allowed = ALLOWED if allowed is None else allowed
    forbidden = phrases(root)
    if not forbidden:
        return [f'{GLOSSARY} has no table say | not | notes']
    problems, used = [], set()
    for name, prose in texts(root, program):
        if prose is None:
            problems.append(f'{name}: nothing to read')
            continue
        for phrase in forbidden:
            for found in phrase.pattern.finditer(prose):
                context = around(prose, found.start(), found.end())
                excuses = [entry for entry in allowed if fnmatch.fnmatch(name, entry[0]) and entry[1] == phrase.text
                           and re.search(entry[2], context)]
                used.update(excuses)
                if not excuses:
                    number = prose.count('\n', 0, found.start()) + 1
                    problems.append(f'{name}:{number}: "{" ".join(found.group(0).split())}" ({GLOSSARY}): ... {context} ...')
    problems += [f'tests/docs/words.py allows {entry} and no text has it' for entry in allowed if entry not in used]
    return problems


def main():
    problems = check(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None)
    print('\n'.join(problems) or 'words: fine')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
