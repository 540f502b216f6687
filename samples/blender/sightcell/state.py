"""What the add-on knows while Blender runs. Nothing here is saved, and nothing refers to data of Blender."""
import os

import bpy

from . import baked, program
from .problem import Problem
from .marks import SETTINGS

job = None  # the running bake: program.Job
messages = []  # of the last bake: messages.Message
summary = ''  # of the last bake, one line
_bake = None  # baked.Bake, as it was when _stamp was taken
_stamp = None


def settings(scene):
    return getattr(scene, SETTINGS)


def program_path():
    """The program that the preferences name."""
    addon = bpy.context.preferences.addons.get(__package__)
    return program.find(bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else '')


def output_path(scene):
    """The .pvs file of a scene."""
    chosen = settings(scene).output
    if not chosen and not bpy.data.filepath:
        raise Problem('save the .blend file first, or choose where the .pvs file goes')
    path = bpy.path.abspath(chosen) if chosen else os.path.splitext(bpy.data.filepath)[0] + '.pvs'
    if not os.path.isabs(path):
        raise Problem('save the .blend file first, or give the .pvs file a whole path')
    return path if path.endswith('.pvs') else path + '.pvs'


def scene_path(pvs):
    """The exported scene that belongs to a .pvs file."""
    return pvs[:-len('.pvs')] + '.glb'


def object_table(scene):
    """For scene_file.Nodes."""
    return {found.name: (found.instance_type != 'NONE', found.parent.name if found.parent else None)
            for found in scene.objects}


def _stamp_of(pvs, scene):
    def file_stamp(path):
        try:
            status = os.stat(path)
            return status.st_mtime_ns, status.st_size, status.st_ino
        except OSError:
            return None
    return pvs, file_stamp(pvs), file_stamp(scene_path(pvs)), frozenset(object_table(scene).items())


def bake(scene):
    """The bake of a scene, read again if its files or the names of objects have changed. Throws Problem."""
    global _bake, _stamp
    pvs = output_path(scene)
    stamp = _stamp_of(pvs, scene)
    if _bake is None or stamp != _stamp:
        forget()
        _bake = baked.Bake(pvs, scene_path(pvs), object_table(scene), program_path())
        _stamp = stamp
    return _bake


def known_bake():
    """The bake that is in memory, or None. For drawing, which reads no files."""
    return _bake


def forget():
    """Closes the bake that is in memory."""
    global _bake
    if _bake is not None:
        _bake.close()
    _bake = None


def redraw():
    """All 3D viewports are drawn again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == 'VIEW_3D':
                area.tag_redraw()
