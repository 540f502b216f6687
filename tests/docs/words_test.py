"""words.py finds phrases that are planted, wherever a reader could find them, and nothing in code."""
import os
import shutil
import unittest

import words
from harness import ROOT, new_folder


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder(self.addCleanup)
        os.makedirs(os.path.join(self.folder, 'docs'))
        shutil.copyfile(os.path.join(ROOT, words.GLOSSARY), os.path.join(self.folder, words.GLOSSARY))
        allowed = [entry for entry in words.ALLOWED if words.fnmatch.fnmatch(words.GLOSSARY, entry[0])]
        for name, value in (('PLACES', [('docs/*.md', 'markdown')]), ('HELP', []), ('ALLOWED', allowed)):
            self.addCleanup(setattr, words, name, getattr(words, name))
            setattr(words, name, value)

    def problems(self, allowed=None):
        return words.check(self.folder, allowed=allowed)

    def page(self, text, name='docs/planted.md', kind='markdown'):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        if kind == 'header':
            words.PLACES = words.PLACES + [(name, kind)]

    def expect(self, line, phrase):
        problems = self.problems()
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(f':{line}: "{phrase}"', problems[0])

    def test_the_glossary_itself(self):
        self.assertEqual(self.problems(), [])

    def test_a_phrase(self):
        self.page('# A page\n\nA wall hides nothing here.\n')
        problems = self.problems()
        self.assertEqual(len(problems), 2, problems)  # "hides" and "hides nothing"
        self.assertIn('docs/planted.md:3: "hides nothing"', problems[1])

    def test_upper_case(self):
        self.page('Fresh Rays bound it.\n')
        self.expect(1, 'Fresh Rays')

    def test_across_a_line_break(self):
        self.page('one\nmany fresh\nrays\n')
        self.expect(2, 'fresh rays')

    def test_across_line_breaks_of_lists_quotes_and_emphasis(self):
        self.page('- many fresh\n  rays\n')
        self.expect(1, 'fresh rays')
        self.page('> many fresh\n> rays\n')
        self.expect(1, 'fresh rays')
        self.page('many **fresh** rays\n')
        self.expect(1, 'fresh rays')

    def test_across_a_line_break_of_a_header(self):
        self.page('/* Bounded by fresh\n * rays.\n */\n', 'include/planted.h', 'header')
        self.expect(1, 'fresh rays')
        self.page('int a;\n  // Bounded by fresh\n  // rays.\n', 'include/planted.h', 'header')
        words.PLACES.pop()
        self.expect(2, 'fresh rays')

    def test_in_a_table_a_link_and_a_heading(self):
        self.page('| a | b |\n|---|---|\n| x | a known miss |\n')
        self.expect(3, 'known miss')
        self.page('[a known\nmiss](page.md)\n')
        self.expect(1, 'known miss')
        self.page('## Known misses\n')
        self.expect(1, 'Known misses')

    def test_in_a_comment_of_a_block_of_code(self):
        self.page('```sh\nmake ring   # cast fresh rays\n```\n')
        self.expect(2, 'fresh rays')
        self.page('```c\nint ring; /* fresh rays */ int hole;\n```\n')
        self.expect(2, 'fresh rays')

    def test_the_beginning_of_a_word(self):
        self.page('It is rasterised.\n')
        self.expect(1, 'rasterised')
        self.page('The colours.\n')
        self.expect(1, 'colours')

    def test_code_and_addresses_are_skipped(self):
        self.page('`fresh rays` and ``a ` ring``\n\n```sh\nhides --ring hole\n```\n\n[x](hole.md) <!-- a known\nmiss -->\n')
        self.assertEqual(self.problems(), [])
        self.page('int hole; /* fine */ const char* ring = "/* hole */";\n', 'include/planted.h', 'header')
        self.assertEqual(self.problems(), [])

    def test_parts_of_words_are_other_words(self):
        self.page('An earring, --safety-ring, a ring-shaped thing, the_ring, whole rings_of.\n')
        self.assertEqual(self.problems(), [])

    def test_lines_are_counted_behind_code_and_comments(self):
        self.page('<!-- a\nb -->\n`c\nd`\n```sh\ne\n```\nfresh rays\n')
        self.expect(8, 'fresh rays')

    def test_what_is_allowed(self):
        self.page('A door that the host hides.\n')
        self.assertEqual(self.problems(), [])
        self.page('A wall hides.\n')
        self.expect(1, 'hides')

    def test_an_allowed_use_that_is_gone(self):
        gone = ('docs/*', 'ring', 'wedding ring')
        problems = self.problems(words.ALLOWED + [gone])
        self.assertEqual(len(problems), 1, problems)
        self.assertIn('wedding ring', problems[0])

    def test_a_help_text(self):
        program = os.path.join(self.folder, 'program')
        with open(program, 'w', encoding='utf-8') as file:
            file.write('#!/bin/sh\necho "$1 --rays  cast fresh"\necho "      rays"\n')
        os.chmod(program, 0o755)
        words.HELP = ['bake']
        problems = words.check(self.folder, program)
        self.assertEqual(len(problems), 2, problems)
        self.assertIn('sightcell bake --help:1: "fresh rays"', problems[0])
        self.assertIn('sightcell bake --help-all:1: "fresh rays"', problems[1])
        with open(program, 'w', encoding='utf-8') as file:
            file.write('#!/bin/sh\nexit 2\n')
        self.assertIn('nothing to read', words.check(self.folder, program)[0])

    def test_no_table_and_no_pages(self):
        words.PLACES = words.PLACES + [('nowhere/*.md', 'markdown')]
        self.assertEqual(self.problems(), ['nowhere/*.md: nothing to read'])
        self.page('# Glossary\n', 'docs/glossary.md')
        self.assertIn('has no table', self.problems()[0])
