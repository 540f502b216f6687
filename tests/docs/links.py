#!/usr/bin/env python3
"""Relative links of all documents lead somewhere: to a file or folder, and to a heading of it.

usage: links.py ROOT    exit code 0: fine, 1: problems, one line each
"""
import os
import re
import sys

sys.dont_write_bytecode = True
import words

SKIPPED = {'build', '.git', 'node_modules'}
LINK = re.compile(r'\]\(([^()\s]+)\)')


def pages(root):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in SKIPPED)
        for name in sorted(names):
            if name.endswith('.md') and not name.endswith('.template.md'):  # templates link from where they go
                yield os.path.relpath(os.path.join(folder, name), root)


def without_code(text):
    """The lines of a page, empty inside fenced blocks; inline code goes, as it may look like a link."""
    lines, fence = [], None
    for line in text.split('\n'):
        mark = words.FENCE.match(line)
        if fence is None and mark:
            fence = mark.group(2)
            line = ''
        elif fence is not None:
            if mark and mark.group(2).startswith(fence) and not mark.group(3):
                fence = None
            line = ''
        lines.append(line)
    return lines


def anchors(lines):
    """Of each heading, as GitHub makes them."""
    found = set()
    for line in lines:
        heading = re.match(r'#{1,6} +(.*?) *#*$', line)
        if not heading:
            continue
        text = re.sub(r'\]\([^)]*\)', ']', heading.group(1)).lower()
        anchor = re.sub(r'[^\w\- ]', '', text).replace(' ', '-')
        number, unique = 0, anchor
        while unique in found:
            number += 1
            unique = f'{anchor}-{number}'
        found.add(unique)
    return found


def check(root):
    texts = {}
    for page in pages(root):
        with open(os.path.join(root, page), encoding='utf-8') as file:
            texts[page] = without_code(file.read())
    problems = [] if texts else ['no pages']
    for page, lines in texts.items():
        for number, line in enumerate(lines, 1):
            for target in LINK.findall(re.sub(r'(`+)(?!`).+?(?<!`)\1(?!`)', '', line)):
                if re.match(r'[a-z]+:', target):
                    continue
                path, _, anchor = target.partition('#')
                path = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
                if path.startswith('..') or not os.path.exists(os.path.join(root, path)):
                    problems.append(f'{page}:{number}: {target}: no such file')
                elif anchor and anchor not in anchors(texts.get(path, [])):
                    problems.append(f'{page}:{number}: {target}: no such heading')
    return problems


def main():
    problems = check(sys.argv[1])
    print('\n'.join(problems) or 'links: fine')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
