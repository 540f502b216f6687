"""The runtime library of Sightcell through ctypes: the functions of sightcell.h that the add-on needs."""
import ctypes
import os
import sys

import numpy

from .problem import Problem

API_VERSION = 1
NO_CELL = 0xFFFFFFFF
DRAW_ALL = 2
NAMES = {'win32': ['sightcell.dll'], 'darwin': ['libsightcell.1.dylib']}.get(sys.platform, ['libsightcell.so.1'])


class Frame(ctypes.Structure):
    _fields_ = [('cell', ctypes.c_uint32), ('flags', ctypes.c_uint32), ('polygon_count', ctypes.c_uint32),
                ('revision', ctypes.c_uint32), ('reserved', ctypes.c_uint32 * 12)]


class Info(ctypes.Structure):
    _fields_ = [('struct_size', ctypes.c_uint32), ('format_version', ctypes.c_uint32), ('layout', ctypes.c_uint32),
                ('polygon_count', ctypes.c_uint32), ('cell_count', ctypes.c_uint32), ('draw_count', ctypes.c_uint32),
                ('range_bound', ctypes.c_uint32), ('margin', ctypes.c_float), ('max_pixel_error', ctypes.c_float),
                ('confidence', ctypes.c_float), ('scene_fingerprint', ctypes.c_uint8 * 16),
                ('player_radius', ctypes.c_float)]


DRAW = numpy.dtype([(name, numpy.uint32) for name in (
    'node', 'mesh', 'primitive', 'instance', 'material', 'group', 'first_source', 'polygon_count', 'first_stored',
    'base_vertex')] + [('host_tag', numpy.uint64)])

CORNER = ctypes.c_float * 3
POINTER = ctypes.c_void_p
SIGNATURES = {
    'sightcell_status_text': (ctypes.c_char_p, [ctypes.c_int]),
    'sightcell_db_open_file': (ctypes.c_int, [ctypes.c_char_p, POINTER, ctypes.POINTER(POINTER)]),
    'sightcell_db_close': (None, [POINTER]),
    'sightcell_db_info': (ctypes.c_int, [POINTER, ctypes.POINTER(Info)]),
    'sightcell_db_cell_box': (ctypes.c_int, [POINTER, ctypes.c_uint32, CORNER, CORNER]),
    'sightcell_db_draws': (ctypes.c_int, [POINTER, POINTER, ctypes.c_size_t, ctypes.POINTER(ctypes.c_size_t)]),
    'sightcell_view_create': (ctypes.c_int, [POINTER, ctypes.POINTER(POINTER)]),
    'sightcell_view_destroy': (None, [POINTER]),
    'sightcell_view_move': (ctypes.c_int, [POINTER, CORNER, ctypes.POINTER(Frame)]),
    'sightcell_view_objects': (ctypes.c_int, [POINTER, POINTER, ctypes.c_size_t]),
}


def candidates(program):
    """Where the library may be: beside the program (bundle, build, installation), then where the system has it."""
    prefix = os.path.dirname(os.path.dirname(os.path.realpath(program)))
    folders = [os.path.join(prefix, 'lib'), os.path.join(prefix, 'lib64'), os.path.join(prefix, 'bin')]
    if os.path.isdir(folders[0]):  # Debian's folder of the architecture
        folders += [entry.path for entry in sorted(os.scandir(folders[0]), key=lambda entry: entry.name)
                    if entry.name.endswith('-linux-gnu')]
    paths = [os.path.join(folder, name) for folder in folders for name in NAMES]
    return [path for path in paths if os.path.exists(path)] + NAMES


def load(program):
    """The library that belongs to the program."""
    for path in candidates(program):
        try:
            library = ctypes.CDLL(path)
            library.sightcell_version.restype = ctypes.c_uint32
            if library.sightcell_version() != API_VERSION:
                raise Problem(f'{path} is of another version: install the one that came with the program')
            for name, (result, arguments) in SIGNATURES.items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
            return library
        except (OSError, AttributeError):
            continue
    raise Problem(f'{NAMES[0]} was not found: install the package libsightcell1, or keep the folders bin and lib of '
                  'the bundle together')


class Database:
    """An open .pvs file and a view of it. close() it."""

    def __init__(self, library, path):
        self.library, self.path = library, path
        self.db, self.view = POINTER(), POINTER()
        self.check(library.sightcell_db_open_file(os.fsencode(path), None, ctypes.byref(self.db)))
        try:
            info = Info(struct_size=ctypes.sizeof(Info))
            self.check(library.sightcell_db_info(self.db, ctypes.byref(info)))
            self.cell_count, self.draw_count, self.margin = info.cell_count, info.draw_count, info.margin
            self.polygon_count = info.polygon_count
            self.words = numpy.zeros((self.draw_count + 63) // 64, numpy.uint64)
            self.new_view()
        except Problem:
            self.close()
            raise

    def check(self, status):
        if status != 0:
            raise Problem(f'{self.path}: {self.library.sightcell_status_text(status).decode()}; bake again')

    def close(self):
        self.library.sightcell_view_destroy(self.view)
        self.library.sightcell_db_close(self.db)
        self.view, self.db = POINTER(), POINTER()

    def new_view(self):
        """A view that is in no cell yet: one that moves keeps its cell a little beyond the box."""
        self.library.sightcell_view_destroy(self.view)
        self.view = POINTER()
        self.check(self.library.sightcell_view_create(self.db, ctypes.byref(self.view)))

    def cell_boxes(self):
        """Corners of all cells in the axes of glTF: an array of (cells, 2, 3)."""
        boxes, low, high = numpy.empty((self.cell_count, 2, 3), numpy.float32), CORNER(), CORNER()
        for cell in range(self.cell_count):
            self.check(self.library.sightcell_db_cell_box(self.db, cell, low, high))
            boxes[cell] = low[:], high[:]
        return boxes

    def draws(self):
        """The draw table: an array of DRAW."""
        table, count = numpy.zeros(self.draw_count, DRAW), ctypes.c_size_t()
        self.check(self.library.sightcell_db_draws(self.db, table.ctypes.data, len(table), ctypes.byref(count)))
        return table

    def move(self, eye):
        """The frame of an eye in the axes of glTF."""
        frame = Frame()
        self.check(self.library.sightcell_view_move(self.view, CORNER(*map(float, eye)), ctypes.byref(frame)))
        return frame

    def seen_draws(self):
        """Whether each draw has a polygon to draw since the last move: an array of booleans."""
        self.check(self.library.sightcell_view_objects(self.view, self.words.ctypes.data, len(self.words)))
        bits = numpy.unpackbits(self.words.view(numpy.uint8), bitorder='little')  # little-endian, as all of Blender's
        return bits[:self.draw_count].astype(bool)
