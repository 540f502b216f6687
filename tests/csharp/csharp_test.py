"""The C# package: it is what make_package.py makes of the headers, mono sees structs as the C compiler does, and a host
in C# gets what a host in C gets."""
import os
import re
import subprocess
import sys
import unittest

import harness

CSHARP = os.path.join(harness.ROOT, 'runtime/csharp')
PACKAGE = os.path.join(CSHARP, 'package')
GOLDEN = os.path.join(harness.ROOT, 'tests/golden')
HERE = os.path.join(harness.ROOT, 'tests/csharp')

sys.path.insert(0, CSHARP)
import make_package


def golden(name):
    return os.path.join(GOLDEN, name + '.pvs')


def sources(folder):
    return sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith('.cs'))


def c_layout(model):
    """A C program that prints sizes, offsets and values of all that the headers declare."""
    lines = [f'print("constant {name}", {name});' for name, _, _ in model.constants]
    for _, members, _ in model.enums:
        lines += [f'print("constant {member}", {member});' for member, _, _ in members]
    for struct in model.structs:
        lines.append(f'print("struct {struct.c_name}", sizeof({struct.c_name}));')
        for field in struct.fields:
            what = f'{struct.c_name}.{field.c_name}'
            lines.append(f'print("field {what}", offsetof({struct.c_name}, {field.c_name}));')
            lines.append(f'print("bytes {what}", sizeof((({struct.c_name}*)0)->{field.c_name}));')
    includes = '\n'.join(f'#include <sightcell/{name}>' for name in sorted(os.listdir(
        os.path.join(harness.ROOT, make_package.HEADERS))) if name.endswith('.h'))
    return f'''#include <stdio.h>
{includes}
static void print(const char* what, unsigned long long number) {{ printf("%s %llu\\n", what, number); }}
int main(void) {{
  {"".join(lines)}
  return 0;
}}
'''


def cs_layout(model):
    """The same in C#: offsets are those of the addresses of fields, which functions of the library see."""
    strip = make_package.stripped
    lines = [f'Line("constant {name}", Constants.{strip(name, ("SIGHTCELL_",))});' for name, _, _ in model.constants]
    for first, members, _ in model.enums:
        kind, _, _, prefixes = make_package.ENUMS[first]
        lines += [f'Line("constant {member}", (uint){kind}.{strip(member, prefixes)});' for member, _, _ in members]
    for struct in model.structs:
        lines.append(f'Line("struct {struct.c_name}", sizeof({struct.name})); {{ {struct.name} x = default({struct.name});')
        for field in struct.fields:
            what, address = f'{struct.c_name}.{field.c_name}', f'(byte*)&x.{field.name}'
            size = f'sizeof({field.declaration.split()[0]})'
            if field.declaration.startswith('fixed'):
                address = f'(byte*)x.{field.name}'
                count = re.search(r'\[(\d+)\]', field.declaration)[1]
                size = f'{count} * sizeof({field.declaration.split()[1]})'
            lines.append(f'Line("field {what}", {address} - (byte*)&x); Line("bytes {what}", {size});')
        lines.append('}')
    return f'''using System;
using Sightcell;
internal static unsafe class Layout
{{
    private static void Line(string what, long number) => Console.WriteLine("{{0}} {{1}}", what, number);
    public static void Print()
    {{
        {"".join(lines)}
    }}
}}
'''


class Csharp(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.model = make_package.read_headers(harness.ROOT)
        layout = cls.path('Layout.cs')
        with open(layout, 'w', encoding='utf-8') as file:
            file.write(cs_layout(cls.model))
        package, host = sources(os.path.join(PACKAGE, 'Runtime')), sources(HERE)
        # Without Unity, and with the sample and what it takes of Unity.
        cls.program, cls.in_unity = cls.path('Program.exe'), cls.path('InUnity.exe')
        cls.compile(cls.program, [*package, layout, *[path for path in host if not path.endswith('unity_stub.cs')]])
        cls.compile(cls.in_unity, ['-define:UNITY_2021_3_OR_NEWER', *package, layout, *host,
                                   *sources(os.path.join(PACKAGE, 'Samples~/Culling'))])

    @classmethod
    def compile(cls, program, arguments):
        done = subprocess.run([harness.SETTINGS['mcs'], '-unsafe', '-warnaserror', '-nologo', f'-out:{program}', *arguments],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)

    @classmethod
    def host(cls, *arguments, program=None):
        code, out, err = harness.run(harness.SETTINGS['mono'], program or cls.program, *arguments,
                                     environment={'LD_LIBRARY_PATH': harness.SETTINGS['library']})
        if code != 0:
            raise RuntimeError(f'{arguments}: {code}\n{out}\n{err}')
        return out

    def damaged(self, name, at, size=None):
        """A copy of a golden file with one byte changed, or cut."""
        data = bytearray(harness.read(golden('v1_small')))
        data[at] ^= 0x55
        with open(self.path(name), 'wb') as file:
            file.write(data[:size])
        return self.path(name)

    def test_layout(self):
        source = self.path('layout.c')
        with open(source, 'w', encoding='utf-8') as file:
            file.write(c_layout(self.model))
        include = os.path.dirname(os.path.join(harness.ROOT, make_package.HEADERS))
        subprocess.run([*harness.SETTINGS['cc'].split(), '-std=c11', '-DSIGHTCELL_STATIC', '-I', include, source, '-o',
                        self.path('layout')], check=True)
        expected = subprocess.run([self.path('layout')], check=True, capture_output=True, text=True).stdout
        self.assertGreater(expected.count('\nfield '), 70)
        self.assertEqual(self.host('layout'), expected)

    def test_functions(self):
        self.assertEqual(int(self.host('functions')), len(self.model.functions))
        # Each has a method in the classes of the package, but those of paged files.
        used = ''.join(harness.read(path).decode() for path in sources(os.path.join(PACKAGE, 'Runtime'))
                       if not path.endswith('Native.cs'))
        paged = {'sightcell_db_open_source', 'sightcell_db_begin_source', 'sightcell_db_opened', 'sightcell_db_deliver',
                 'sightcell_db_prefetch'}
        counts = {'sightcell_db_polygon_count', 'sightcell_db_cell_count'}  # Info has these
        unused = {name for name, *_ in self.model.functions if f'Native.{name}(' not in used}
        self.assertEqual(unused, paged | counts)

    def test_same_as_c(self):
        files = [golden(name[:-4]) for name in sorted(os.listdir(GOLDEN)) if name.endswith('.pvs')]
        size = os.path.getsize(golden('v1_small'))
        files += [self.damaged(f'damaged{i}.pvs', i * size // 24) for i in range(24)]
        expected = subprocess.run([harness.program('sightcell-test-csharp-dump'), *files], check=True, capture_output=True,
                                  text=True).stdout.splitlines()
        self.assertGreater(len(expected), 5000)
        self.assertTrue(any(line.startswith('move') and int(line.split()[3]) & 16 for line in expected), 'no damaged frame')
        found = self.host('dump', *files).splitlines()
        differing = [(a, b) for a, b in zip(expected, found) if a != b]
        self.assertEqual(differing[:5], [])
        self.assertEqual(len(found), len(expected))

    def test_frames_allocate_nothing(self):
        self.assertEqual(self.host('allocations', golden('v1_chunks')), 'frames 0\nwaste seen\n')

    def test_lifetime(self):
        self.assertEqual(self.host('lifetime', golden('v1_small')), 'view True\nclosed True True\ncollected\n')

    def test_errors(self):
        absent = self.path('nö_such_file.pvs')
        damaged, cut = self.damaged('damaged.pvs', 40), self.damaged('cut.pvs', -1, 100)
        with open(self.path('text.pvs'), 'w', encoding='utf-8') as file:
            file.write('no .pvs file, but long enough to have a header of one: ' + 200 * '.')
        found = self.host('errors', golden('v1_small'), absent, damaged, cut, self.path('text.pvs'))
        self.assertEqual([line.split(' | ')[0] for line in found.splitlines()], [
            'nö_such_file.pvs: Io io', 'damaged.pvs: Checksum checksum', 'bytes of damaged.pvs: Checksum checksum',
            'cut.pvs: Truncated truncated', 'bytes of cut.pvs: Truncated truncated', 'text.pvs: NotOurs not_ours',
            'bytes of text.pvs: NotOurs not_ours', 'null path: ArgumentNullException',
            'null database: ArgumentNullException', 'no such cell: Argument argument', 'NaN: Argument argument',
            'after NaN: some ranges', 'small span: Capacity capacity', 'no importance: Absent absent',
            'no names: Absent absent', 'no casters: Absent absent', 'no lights: Absent absent',
            'no residency: Absent absent',
            'clusters of polygons: Absent absent',
            'table of one: Argument argument', 'rows: Argument argument', 'disposed view: ObjectDisposedException',
            'disposed database: ObjectDisposedException'])
        self.assertRegex(found, rf'\| sightcell: {re.escape(absent)}: [a-z].* \[io\]\n')

    def test_arrays_of_unity(self):
        self.assertEqual(self.host('arrays', golden('v1_small'), program=self.in_unity), ''.join(
            f'{name} same\n' for name in ('objects', 'ranges', 'commands', 'indices', 'clusters')) + 'axes 1 2 3 -1\n')

    def test_readme(self):
        self.assertEqual(self.host('ten', golden('v1_small')), 'shown 3 of 4\nindices same\n')
        text = harness.read(os.path.join(HERE, 'TenLines.cs')).decode()
        regions = [re.sub(r'^ {8}', '', lines, flags=re.MULTILINE) for lines in
                   re.findall(r'^ */\* \[[^*]+ \*/\n(.*?)^ */\* [^*]+\] \*/$', text, re.MULTILINE | re.DOTALL)]
        readme = harness.read(os.path.join(PACKAGE, 'README.md')).decode()
        self.assertEqual(re.findall(r'^```csharp\n(.*?)^```$', readme, re.MULTILINE | re.DOTALL), regions)


if __name__ == '__main__':
    unittest.main()
