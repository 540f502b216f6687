"""links.py finds links to what does not exist, and no others."""
import os
import unittest

import links
from harness import new_folder


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder(self.addCleanup)
        os.makedirs(os.path.join(self.folder, 'docs'))
        self.page('docs/other.md', '# Other page\n\n## Files: `--profile`, all\n\n## Twice\n\n## Twice\n')

    def page(self, name, text):
        with open(os.path.join(self.folder, name), 'w', encoding='utf-8') as file:
            file.write(text)

    def problems(self, text, name='README.md'):
        self.page(name, text)
        return links.check(self.folder)

    def test_good_links(self):
        text = ('# Here\n[a](docs/other.md) [b](docs) [c](#here) [d](https://example.com/x#y) [e](docs/other.md#twice-1)\n'
                '[f](docs/other.md#files---profile-all)\n`[g](gone.md)`\n```c\n[h](gone.md)\n```\n')
        self.assertEqual(self.problems(text), [])
        self.assertEqual(self.problems('[up](../README.md#here)\n', 'docs/third.md'), [])

    def test_a_file_that_is_gone(self):
        self.assertEqual(self.problems('# Here\n\nsee [a](docs/gone.md)\n'),
                         ['README.md:3: docs/gone.md: no such file'])
        self.assertEqual(self.problems('![picture](gone.png)\n'), ['README.md:1: gone.png: no such file'])

    def test_a_file_outside(self):
        self.assertEqual(self.problems('[a](../other/README.md)\n'), ['README.md:1: ../other/README.md: no such file'])

    def test_a_heading_that_is_gone(self):
        self.assertEqual(self.problems('[a](docs/other.md#gone)\n'),
                         ['README.md:1: docs/other.md#gone: no such heading'])
        self.assertEqual(self.problems('[a](#gone)\n```sh\n# gone\n```\n'), ['README.md:1: #gone: no such heading'])
        self.assertEqual(self.problems('[a](docs/other.md#twice-2)\n'),
                         ['README.md:1: docs/other.md#twice-2: no such heading'])
