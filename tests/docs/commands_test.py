"""commands.py finds commands that fail and names that do not exist, in every place where a page can have them."""
import os
import shutil
import unittest

import commands
from harness import BIN, ROOT, new_folder


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder(self.addCleanup)
        shutil.copyfile(os.path.join(ROOT, 'CMakePresets.json'), os.path.join(self.folder, 'CMakePresets.json'))
        for folder in ('docs', 'scripts', 'samples', 'tests', 'runtime/package'):
            os.makedirs(os.path.join(self.folder, folder))
        for name in ('CMakeLists.txt', 'runtime/package/bundle.cmake', 'scripts/demo'):
            shutil.copyfile(os.path.join(ROOT, name), os.path.join(self.folder, name))

    def problems(self, **pages):
        for name, text in pages.items():
            path = 'README.md' if name == 'readme' else f'docs/{name}.md'
            with open(os.path.join(self.folder, path), 'w', encoding='utf-8') as file:
                file.write(text)
        return commands.check(self.folder, BIN)

    def test_what_is_right(self):
        good = ('`sightcell bake level.glb`, `--cell-limit 4`, `scripts/demo`, `cmake --preset web`\n'
                '```sh\nexport PATH="$PWD/build/release/bin:$PATH"  # once\nsightcell info level.glb --json | grep cells'
                ' || sightcell info level.pvs\n```\n<!-- not run: opens a window -->\n```sh\n'
                'scripts/demo level.glb\nbuild/release/bin/sightcell verify a b \\\n  --rays 4\n'
                'cmake --install build/release --component bundle\n(cd build && cmake --build --preset release)\n```\n'
                '```text\nsightcell: level.glb: cannot be read\n```\n')
        self.assertEqual(self.problems(readme=good), [])

    def test_a_command_that_fails(self):
        problems = self.problems(readme='a\n```sh\ntrue\n```\n```sh\nsightcell info nowhere.glb\ntrue\n```\n',
                                 other='```sh\ntest -f level.pvs\n```\n')
        self.assertEqual(len(problems), 1, problems)
        self.assertIn('README.md:5: exit code 4', problems[0])

    def test_what_does_not_exist(self):
        block = '<!-- not run: because -->\n```sh\n{}\n```\n'
        for command, problem in {
                'sightcell bake a -o b --no-such-option 3': 'sightcell bake has no option --no-such-option',
                'sightcell bake a -o b --cell 3': 'sightcell bake has no option --cell',
                'X=1 sightcell --none-such': 'sightcell  has no option --none-such',
                'true && sightcell backe a': 'sightcell has no verb backe',
                'build/release/bin/sightcell-no a': 'there is no program sightcell-no',
                'sightcell-city --poly 3 | cat': 'sightcell-city  has no option --poly',
                'scripts/no-such-script': 'scripts/no-such-script does not exist',
                'cmake --preset no': 'there is no configure preset no',
                'cmake --build --preset runtime': 'there is no build preset runtime',
                'cmake --install b --component bundles': 'there is no component bundles',
                'cmake --preset dev -DSIGHTCELL_NO=ON': 'there is no option SIGHTCELL_NO',
                'no-such-program a': 'no-such-program does not exist'}.items():
            known = commands.Known(self.folder, BIN)
            words = list(commands.commands_of(command))
            self.assertEqual([p for w in words for p in commands.check_command(w, known)], [problem], command)
        problems = self.problems(readme='```sh\ntrue\n```\n' + block.format('scripts/no'), other='`--no-such`\n')
        self.assertEqual(problems, ['README.md:5: scripts/no does not exist',
                                    'docs/other.md:1: no program has the option --no-such'])

    def test_inline_code(self):
        known = commands.Known(self.folder, BIN)
        for code in ('sightcell bake a --nope', 'sightcell nope a', 'cmake --preset nope', 'scripts/nope', '--nope 3',
                     'tests/nope.py', '-DSIGHTCELL_NOPE=ON'):
            self.assertEqual(len(list(commands.check_inline(code, known))), 1, code)
        for code in ('sightcell_view_move', 'sightcell.h', 'sightcell', 'sightcell VERB --help', '--json', 'sightcell-tools',
                     '-DSIGHTCELL_BUILD_BAKE=OFF', '--quiet-' + '-', 'samples'):
            self.assertEqual(list(commands.check_inline(code, known)), [], code)

    def test_blocks_that_nobody_reads(self):
        problems = self.problems(readme='```\nsightcell bake\n```\n```text\n$ sightcell info a\n```\n'
                                        '<!-- not run: x -->\n```c\nint a;\n```\n')
        self.assertEqual([p.split(': ')[0] for p in problems], ['README.md:1', 'README.md:8', 'README.md:4',
                                                                'no page has a command to run'])
