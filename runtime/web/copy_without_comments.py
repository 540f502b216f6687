#!/usr/bin/env python3
"""Copies JavaScript without comments on lines of their own and after two spaces. Pages load these files as they are; the declarations (.d.ts)
describe the interface and are copied whole.

usage: copy_without_comments.py FOLDER FILE.js ...
"""
import os
import re
import sys

COMMENT = re.compile(r'^[ \t]*(?://[^\n]*|/\*(?:(?!\*/).)*\*/)[ \t]*\n', re.MULTILINE | re.DOTALL)
AFTER_CODE = re.compile(r'  // [^\n\'"`]*$', re.MULTILINE)  # without quotes: it cannot end a string


def main():
    folder, paths = sys.argv[1], sys.argv[2:]
    for path in paths:
        with open(path, encoding='utf-8') as file:
            text = AFTER_CODE.sub('', COMMENT.sub('', file.read()))
        with open(os.path.join(folder, os.path.basename(path)), 'w', encoding='utf-8') as file:
            file.write(text.lstrip('\n'))


if __name__ == '__main__':
    main()
