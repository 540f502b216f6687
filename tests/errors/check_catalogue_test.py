"""check_catalogue.py fails when an id is added without an entry or a test, and in every other way it promises.
"""
import os
import shutil
import unittest

import cases
import check_catalogue
from harness import ROOT, new_folder


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder(self.addCleanup)
        for room in ('bake', 'tests/unit', 'tests/cli'):
            shutil.copytree(os.path.join(ROOT, room), os.path.join(self.folder, room))
        self.cases, self.unit_tests = list(cases.CASES), dict(cases.UNIT_TESTS)

    def problems(self):
        return check_catalogue.check(self.folder, self.cases, self.unit_tests)

    def expect(self, *parts):
        problems = self.problems()
        self.assertTrue(any(all(part in problem for part in parts) for problem in problems), problems)

    def plant(self, name, text):
        with open(os.path.join(self.folder, name), 'w', encoding='utf-8') as file:
            file.write(text)

    def replace(self, name, old, new):
        with open(os.path.join(self.folder, name), encoding='utf-8') as file:
            text = file.read()
        self.assertIn(old, text)
        self.plant(name, text.replace(old, new, 1))

    def test_nothing_is_wrong_now(self):
        self.assertEqual(self.problems(), [])

    def test_an_id_without_entry_and_test(self):
        for text in ('throw error(error_kind::failed, "new.one", "a", "b", "c");', 'refuse("new.one", "a");',
                     'const char* id = "new.one";', 'print("it is broken [new.one]\\n");'):
            self.plant('bake/src/planted.cpp', f'void f() {{ {text} }}')
            self.expect('new.one', 'bake/src/planted.cpp', 'has no entry')
            self.expect('new.one', 'provoked by nothing')

    def test_an_id_that_is_no_literal(self):
        self.plant('bake/src/planted.cpp', 'throw error(error_kind::failed, "new." + one, "a", "b", "c");')
        self.expect('planted.cpp', 'give it a literal')

    def test_comments_are_not_sources(self):
        self.plant('bake/src/planted.cpp', '// throws "new.one"\n/* or "new.two" */ const char* s = "http://x";\n')
        self.assertEqual(self.problems(), [])

    def test_an_entry_without_an_id(self):
        self.replace('bake/ERRORS.md', '| `cells.bad-box`', '| `cells.bad-bax` | 4 | a | b |\n| `cells.bad-box`')
        self.expect('cells.bad-bax', 'in no source')

    def test_an_entry_that_is_gone_or_malformed(self):
        self.replace('bake/ERRORS.md', '| `cells.bad-box` | 4 |', '| `cells.bad-box` |')
        self.expect('not a row')
        self.expect('cells.bad-box', 'has no entry')

    def test_another_exit_code(self):
        self.replace('bake/ERRORS.md', '| `cells.bad-box` | 4 |', '| `cells.bad-box` | 1 |')
        self.expect('cells.bad-box', 'provoked are [4]')
        self.replace('bake/ERRORS.md', '| `gl.error` | 1 |', '| `gl.error` | 4 |')
        self.expect('gl.error', 'the sources say exit code [1]')

    def test_a_case_that_is_gone(self):
        self.cases = [case for case in self.cases if case[0] != 'cells.bad-box']
        self.expect('cells.bad-box', 'provoked by nothing')

    def test_a_unit_test_that_does_not_mention_the_id(self):
        self.unit_tests['gl.error'] = 'tests/unit/picture/compare_test.cpp'
        self.expect('gl.error', 'does not mention it')
        self.unit_tests['gl.error'] = 'tests/unit/picture/nowhere.cpp'
        self.expect('gl.error', 'does not exist')

    def test_cases_of_ids_that_are_gone(self):
        self.unit_tests['old.one'] = 'tests/unit/picture/compare_test.cpp'
        self.expect('old.one', 'in no source')

    def test_an_empty_tree(self):
        shutil.rmtree(os.path.join(self.folder, 'bake'))
        self.assertIsNone(self.problems())
