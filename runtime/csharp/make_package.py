#!/usr/bin/env python3
"""Writes the generated files of the C# package: Native.cs, which is the public headers of the runtime in C#, the license,
the version in package.json, and a .meta file for each file and folder, which Unity needs where it cannot write them itself.

usage: make_package.py ROOT            writes what has changed
       make_package.py ROOT --check    exit code 1 where a file is not what this program would write

Names are made from those of the headers by rules. The tables below have the names that would clash with names of .NET
or Unity, and those of enums without a name. A type that no rule knows is an error.
"""
import glob
import hashlib
import os
import re
import sys

PACKAGE = 'runtime/csharp/package'
NATIVE = f'{PACKAGE}/Runtime/Native.cs'
HEADERS = 'runtime/include/sightcell'

# Structs whose name in C# is not the one of C in camel case.
STRUCT_NAMES = {
    'sightcell_allocator': 'MemoryAllocator',  # UnityEngine has an Allocator
    'sightcell_command': 'IndirectCommand',
    'sightcell_db_stats': 'DatabaseStats',
    'sightcell_info': 'DatabaseInfo',
    'sightcell_light': 'BakedLight',           # UnityEngine has a Light
    'sightcell_range': 'PolygonRange',         # System has a Range
    'sightcell_source': 'PagedSource',
    'sightcell_texture': 'ResidentTexture',    # UnityEngine has a Texture
}
# First constant of an enum -> its name, its type, whether its values combine, what its members begin with.
ENUMS = {
    'SIGHTCELL_OK': ('Status', 'int', False, ('SIGHTCELL_ERR_', 'SIGHTCELL_')),
    'SIGHTCELL_OUTSIDE_ALL': ('ViewPolicy', 'uint', True, ('SIGHTCELL_',)),
    'SIGHTCELL_FRAME_CHANGED': ('FrameFlags', 'uint', True, ('SIGHTCELL_FRAME_',)),
    'SIGHTCELL_DEBUG_CELL': ('DebugLineKinds', 'uint', True, ('SIGHTCELL_DEBUG_',)),
    'SIGHTCELL_NAME_NODE': ('NameKind', 'uint', False, ('SIGHTCELL_NAME_',)),
}
# Fields of type uint32_t that have the values of an enum.
FIELD_TYPES = {'sightcell_frame.flags': 'FrameFlags', 'sightcell_debug_line.kind': 'DebugLineKinds'}
# Type in C -> type in C#, size; both are blittable. Vectors are structs of Types.cs.
NUMBERS = {'uint8_t': ('byte', 1), 'uint32_t': ('uint', 4), 'uint64_t': ('ulong', 8), 'float': ('float', 4),
           'double': ('double', 8)}
VECTORS = {'float[3]': ('Float3', 12, 4), 'double[3]': ('Double3', 24, 8)}


def camel(name):
    return ''.join(part[:1].upper() + part[1:] for part in name.lower().split('_'))


class Field:
    """A field of a struct. offset and size are None where they depend on the size of a pointer."""

    def __init__(self, c_name, name, declaration, size, align, comment):
        self.c_name, self.name, self.declaration, self.comment = c_name, name, declaration, comment
        self.size, self.align, self.offset = size, align, None


class Struct:
    def __init__(self, c_name, fields, comment):
        self.c_name, self.fields, self.comment = c_name, fields, comment
        self.name = STRUCT_NAMES.get(c_name, camel(c_name.removeprefix('sightcell_')))
        self.size = None
        if all(field.size is not None for field in fields):
            at = 0
            for field in fields:
                at += -at % field.align
                field.offset = at
                at += field.size
            self.size = at + -at % max(field.align for field in fields)


class Model:
    """All that the headers declare, in the order of the declarations."""

    def __init__(self):
        self.constants, self.enums, self.structs, self.functions, self.delegates = [], [], [], [], []
        self.opaque = set()


def without_comments(text):
    return re.sub(r'/\*.*?\*/', ' ', text, flags=re.DOTALL)


def comment_before(text, at):
    """The lines of the comment that ends where the declaration at `at` begins."""
    found = re.search(r'/\*((?:(?!\*/).)*)\*/\s*$', text[:at], re.DOTALL)
    if not found or found[1].strip().startswith('----') or '\n\n' in text[found.end(1) + 2:at]:
        return []
    return [re.sub(r'^ ?\*? ?', '', line, count=1).rstrip() for line in found[1].strip('\n').split('\n')]


def split_parameters(text):
    """Commas outside of the parentheses of a function pointer divide parameters."""
    return [] if text.strip() == 'void' else [part.strip() for part in re.split(r',(?![^(]*\))', text)]


def field_of(owner, kind, name, extent, comment, model):
    full = f'{owner}.{name}'
    if kind.endswith('*'):
        return [Field(name, camel(name), f'IntPtr {camel(name)}', None, None, comment)]
    if kind + extent in VECTORS:
        kind, size, align = VECTORS[kind + extent]
        return [Field(name, camel(name), f'{kind} {camel(name)}', size, align, comment)]
    if kind not in NUMBERS:
        raise SystemExit(f'make_package.py: no C# type for {full}, a {kind}{extent}')
    number, size = NUMBERS[kind]
    if extent:
        count = int(extent[1:-1])
        return [Field(name, camel(name), f'fixed {number} {camel(name)}[{count}]', size * count, size, comment)]
    return [Field(name, camel(name), f'{FIELD_TYPES.get(full, number)} {camel(name)}', size, size, comment)]


def parse_struct(owner, body, comment, model):
    fields = []
    for declaration, trailing in re.findall(r'([^;]+);(?:[ \t]*/\*(.*?)\*/)?', body, re.DOTALL):
        text = ' '.join(without_comments(declaration).split())
        note = [' '.join(trailing.split())] if trailing else []
        function = re.fullmatch(r'(.+?) ?\(\*(\w+)\)\((.*)\)', text)
        if function:
            delegate = camel(owner.removeprefix('sightcell_')) + camel(function[2])
            model.delegates.append((delegate, function[1], split_parameters(function[3])))
            fields.append(Field(function[2], camel(function[2]), f'IntPtr {camel(function[2])}', None, None,
                                [f'A function: {delegate}.']))
            continue
        first, *others = text.split(',')
        kind, name, extent = re.fullmatch(r'(.+?[ *])(\w+)((?:\[\w+\])?)', first).groups()
        for part in [name + extent, *map(str.strip, others)]:
            name, extent = re.fullmatch(r'(\w+)((?:\[\w+\])?)', part).groups()
            fields += field_of(owner, kind.strip(), name, extent, note, model)
    model.structs.append(Struct(owner, fields, comment))


def parse_enum(body, comment, model):
    members = re.findall(r'(SIGHTCELL_\w+) = (\w+?)u?\b,?(?:[ \t]*/\*(.*?)\*/)?', body)
    if members[0][0] not in ENUMS:
        raise SystemExit(f'make_package.py: the enum of {members[0][0]} has no name in C#: add it to ENUMS')
    model.enums.append((members[0][0], members, comment))


def parse_header(text, model):
    for name, value in re.findall(r'^#define (SIGHTCELL_\w+) (0x[0-9A-Fa-f]+|\d+)u?$', text, re.MULTILINE):
        model.constants.append((name, value, comment_before(text, text.index(f'#define {name} '))))
    for found in re.finditer(r'^(?:typedef )?enum\s*\w*\s*\{(.*?)\}\s*\w*\s*;', text, re.MULTILINE | re.DOTALL):
        parse_enum(found[1], comment_before(text, found.start()), model)
    for found in re.finditer(r'^typedef struct (\w+) (\w+);', text, re.MULTILINE):
        model.opaque.add(found[1])
    for found in re.finditer(r'^typedef struct (\w+) \{\n(.*?)^\} \1;', text, re.MULTILINE | re.DOTALL):
        parse_struct(found[1], found[2], comment_before(text, found.start()), model)
    for found in re.finditer(r'^SIGHTCELL_API ([^(]*?)(sightcell_\w+)\((.*?)\);', text, re.MULTILINE | re.DOTALL):
        parameters = [' '.join(each.split()) for each in split_parameters(found[3])]
        model.functions.append((found[2], found[1].strip(), parameters, comment_before(text, found.start())))


def read_headers(root):
    model = Model()
    paths = sorted(glob.glob(os.path.join(root, HEADERS, '*.h')),
                   key=lambda path: (os.path.basename(path) != 'sightcell.h', path))
    for path in paths:
        with open(path, encoding='utf-8') as file:
            parse_header(file.read(), model)
    if not model.functions:
        raise SystemExit(f'make_package.py: no function in {root}/{HEADERS}/*.h')
    return model


def passed_type(kind, model):
    """The C# type of a parameter or a result."""
    kind = kind.replace('const', '').replace(' ', '')
    base, stars = kind.rstrip('*'), len(kind) - len(kind.rstrip('*'))
    if base in model.opaque:
        return 'IntPtr' + '*' * (stars - 1)
    simple = {'void': 'void', 'char': 'byte', 'size_t': 'UIntPtr', 'sightcell_status': 'Status'}
    simple |= {name: number for name, (number, _) in NUMBERS.items()}
    simple |= {struct.c_name: struct.name for struct in model.structs}
    if base not in simple:
        raise SystemExit(f'make_package.py: no C# type for a parameter of type {kind}')
    return simple[base] + '*' * stars


def parameter(text, model, pointers_as=None):
    kind, name, extent = re.fullmatch(r'(.+?[ *])(\w+)((?:\[\w*\])?)', text).groups()
    kind = passed_type(kind.strip() + ('*' if extent else ''), model)
    words = name.split('_')
    name = words[0] + ''.join(word.capitalize() for word in words[1:])
    return f'{pointers_as if pointers_as and kind.endswith("*") else kind} {"@" if name in ("out", "object") else ""}{name}'


def summary(lines, indent):
    text = [line.replace('&', '&amp;').replace('<', '&lt;').replace('>', '&gt;') for line in lines]
    if not text:
        return []
    if len(text) == 1:
        return [f'{indent}/// <summary>{text[0]}</summary>']
    return [f'{indent}/// <summary>'] + [f'{indent}/// {line}'.rstrip() for line in text] + [f'{indent}/// </summary>']


def stripped(name, prefixes):
    return camel(name.removeprefix(next(prefix for prefix in prefixes if name.startswith(prefix))))


def enum_lines(first, members, comment):
    name, kind, combine, prefixes = ENUMS[first]
    lines = summary(comment, '    ')
    lines += ['    [Flags]'] if combine else []
    lines += [f'    public enum {name} : {kind}', '    {']
    for member, value, note in members:
        lines += summary([note.strip()] if note else [], '        ')
        lines.append(f'        {stripped(member, prefixes)} = {value},')
    return lines + ['    }', '']


def struct_lines(struct):
    size = '' if struct.size is None else f', Size = {struct.size}'
    lines = summary(struct.comment, '    ')
    lines += [f'    [StructLayout(LayoutKind.Sequential{size})]', f'    public unsafe struct {struct.name}', '    {']
    for field in struct.fields:
        lines += summary(field.comment, '        ')
        lines.append(f'        public {field.declaration};')
    if struct.fields[0].c_name == 'struct_size':
        lines += ['', f'        /// <summary>A struct whose StructSize is set, as functions need it.</summary>',
                  f'        public static {struct.name} Sized => new {struct.name} {{ StructSize = {struct.size} }};']
    return lines + ['    }', '']


def function_lines(name, result, parameters, comment, model):
    arguments = ', '.join(parameter(each, model) for each in parameters)
    return summary(comment, '        ') + [
        '        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]',
        f'        public static extern {passed_type(result, model)} {name}({arguments});', '']


def native_text(model):
    lines = ['// Made by runtime/csharp/make_package.py from the headers in runtime/include/sightcell. Edit those instead.',
             '// The headers have the conventions of all functions, such as coordinates, lists and threads.',
             '#pragma warning disable IDE1006 // functions have the names that they have in C', '',
             'using System;', 'using System.Runtime.InteropServices;', 'using System.Security;', '',
             'namespace Sightcell', '{']
    lines += ['    /// <summary>Constants of the headers.</summary>', '    public static class Constants', '    {']
    for name, value, comment in model.constants:
        lines += summary(comment, '        ') + [f'        public const uint {stripped(name, ("SIGHTCELL_",))} = {value};']
    lines += ['    }', '']
    for each in model.enums:
        lines += enum_lines(*each)
    for name, result, parameters in model.delegates:
        arguments = ', '.join(parameter(each, model, 'IntPtr') for each in parameters)
        result = passed_type(result, model).replace('void*', 'IntPtr')
        lines += ['    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]',
                  f'    public delegate {result} {name}({arguments});', '']
    for struct in model.structs:
        lines += struct_lines(struct)
    lines += ['    /// <summary>The functions of the headers. The classes of this package call them.</summary>',
              '    [SuppressUnmanagedCodeSecurity]', '    public static unsafe class Native', '    {',
              '#if !UNITY_EDITOR && (UNITY_IOS || UNITY_TVOS || UNITY_WEBGL)',
              '        private const string Library = "__Internal"; // linked into the player', '#else',
              '        private const string Library = "sightcell";', '#endif', '']
    for each in model.functions:
        lines += function_lines(*each, model)
    lines += id_lines(model)
    return '\n'.join(lines + ['    }', '}', ''])


def id_lines(model):
    members = next(members for first, members, _ in model.enums if first == 'SIGHTCELL_OK')
    prefixes = ENUMS['SIGHTCELL_OK'][3]
    lines = ['        /// <summary>The id of a status, such as not_ours.</summary>',
             '        public static string StatusId(Status status)', '        {', '            switch (status)',
             '            {']
    for member, _, _ in members:
        text = member.removeprefix(next(prefix for prefix in prefixes if member.startswith(prefix))).lower()
        lines.append(f'                case Status.{stripped(member, prefixes)}: return "{text}";')
    return lines + ['                default: return "status_" + (int)status;', '            }', '        }']


def meta_text(path, is_folder):
    """Unity identifies an asset by the guid of its .meta file, which has to stay the same from version to version."""
    guid = hashlib.md5(f'sightcell/{path}'.encode()).hexdigest()
    return f'fileFormatVersion: 2\nguid: {guid}\n' + ('folderAsset: yes\n' if is_folder else '')


def meta_files(root):
    """Path -> text. Unity ignores the folder Samples~ itself, but copies the .meta files in it."""
    texts = {}
    top = os.path.join(root, PACKAGE)
    for folder, folders, names in os.walk(top):
        folders.sort()
        for name in sorted(names) + folders:
            path = os.path.relpath(os.path.join(folder, name), top).replace(os.sep, '/')
            if not name.endswith(('.meta', '~')):
                texts[f'{PACKAGE}/{path}.meta'] = meta_text(path, name in folders)
    return texts


def package_texts(root):
    """Path -> text of all generated files."""
    version = re.search(r'^project\(sightcell VERSION ([\d.]+)', read(os.path.join(root, 'CMakeLists.txt')), re.MULTILINE)[1]
    manifest = f'{PACKAGE}/package.json'
    texts = {NATIVE: native_text(read_headers(root)), f'{PACKAGE}/LICENSE.md': read(os.path.join(root, 'LICENSE')),
             manifest: re.sub(r'"version": "[^"]*"', f'"version": "{version}"', read(os.path.join(root, manifest)))}
    made = [path.removeprefix(PACKAGE + '/') for path in texts]
    return texts | meta_files(root) | {f'{PACKAGE}/{path}.meta': meta_text(path, False) for path in made}


def differing(root, texts):
    """The files that are not as they would be written, and .meta files that nothing has."""
    found = [path for path, text in texts.items() if read(os.path.join(root, path)) != text]
    for folder, _, names in os.walk(os.path.join(root, PACKAGE)):
        paths = [os.path.relpath(os.path.join(folder, name), root).replace(os.sep, '/') for name in names]
        found += [path for path in paths if path.endswith('.meta') and path not in texts]
    return sorted(set(found))


def read(path):
    if not os.path.exists(path):
        return None
    with open(path, encoding='utf-8', newline='') as file:
        return file.read()


def main():
    root, *options = sys.argv[1:]
    texts = package_texts(root)
    changed = differing(root, texts)
    if options == ['--check']:
        if changed:
            sys.exit(f'run runtime/csharp/make_package.py: {", ".join(changed)} would change')
        return
    for path in changed:
        if path not in texts:
            os.remove(os.path.join(root, path))
            continue
        with open(os.path.join(root, path), 'w', encoding='utf-8', newline='') as file:
            file.write(texts[path])


if __name__ == '__main__':
    main()
