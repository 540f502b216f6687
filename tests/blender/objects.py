"""Objects that the scripts inside Blender make and mark."""
import bpy


def box(name, low, high, collection=None):
    """A closed box, seen from outside."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    made = bpy.data.objects.new(name, mesh)
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def empty(name, location, scale=(1, 1, 1)):
    made = bpy.data.objects.new(name, None)
    made.location, made.scale = location, scale
    bpy.context.scene.collection.objects.link(made)
    return made


def select(*objects):
    bpy.context.view_layer.update()
    for each in bpy.context.view_layer.objects:
        each.select_set(each in objects)
    bpy.context.view_layer.objects.active = objects[0]


def mark(kind, *objects, group=''):
    select(*objects)
    bpy.ops.sightcell.mark(kind=kind, group=group)
