"""Operators that mark objects."""
import bpy
from bpy.props import EnumProperty, StringProperty

from . import marks, state

CELL_SIZE = 2.0, 2.0, 1.0  # half of a new cell box, in meters


def editable(context):
    """The selected objects that this file may change."""
    return [found for found in context.selected_objects if found.library is None]


class SIGHTCELL_OT_mark(bpy.types.Operator):
    bl_idname = 'sightcell.mark'
    bl_label = 'Mark'
    bl_description = 'Mark the selected objects'
    bl_options = {'REGISTER', 'UNDO'}

    kind: EnumProperty(name='Mark', items=[(kind, name, meaning) for kind, name, meaning, _ in marks.KINDS])
    group: StringProperty(name='Name', description='Of a door. Empty: the name in the panel')

    @classmethod
    def poll(cls, context):
        return bool(context.selected_objects)

    @classmethod
    def description(cls, context, properties):
        return next(meaning for kind, _, meaning, _ in marks.KINDS if kind == properties.kind)

    def execute(self, context):
        group = self.group or state.settings(context.scene).group
        if self.kind == 'GROUP' and not group:
            self.report({'ERROR'}, 'Give the door a name')
            return {'CANCELLED'}
        found = editable(context)
        for each in found:
            marks.write(each, self.kind, group)
            if self.kind == 'CELL':
                show_as_cell(each)
        linked = len(context.selected_objects) - len(found)
        if linked:
            self.report({'WARNING'}, f'{linked} linked objects belong to another file: mark them there')
        return {'FINISHED'} if found else {'CANCELLED'}


def show_as_cell(marked):
    """The box of an Empty is that of the cube from -1 to 1: drawn so, at the same size."""
    if marked.type == 'EMPTY':
        if marked.empty_display_type == 'CUBE' and not marked.children:
            marked.scale = [factor * marked.empty_display_size for factor in marked.scale]
        marked.empty_display_type, marked.empty_display_size = 'CUBE', 1.0
    elif marked.type == 'MESH':
        marked.display_type = 'WIRE'


class SIGHTCELL_OT_clear_marks(bpy.types.Operator):
    bl_idname = 'sightcell.clear_marks'
    bl_label = 'Clear'
    bl_description = 'Remove the marks of the selected objects: occluders that do not move'
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return bool(context.selected_objects)

    def execute(self, context):
        cleared = [marks.clear(found) for found in editable(context)]
        return {'FINISHED'} if any(cleared) else {'CANCELLED'}


class SIGHTCELL_OT_add(bpy.types.Operator):
    bl_idname = 'sightcell.add'
    bl_label = 'Add'
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return context.mode == 'OBJECT'

    kind: EnumProperty(name='Kind', items=[('START', 'Start', 'A player begins at the 3D cursor'),
                                           ('CELL', 'Cell box', 'A box of 4 x 4 x 2 m around the 3D cursor. Scale it')])

    @classmethod
    def description(cls, context, properties):
        if properties.kind == 'START':
            return 'Add a start at the 3D cursor: the bake finds the floors that players reach from there'
        return 'Add a cell box around the 3D cursor. Move and scale it to where the camera can be'

    def execute(self, context):
        added = bpy.data.objects.new('Start' if self.kind == 'START' else 'Cell', None)
        added.location = context.scene.cursor.location
        added.empty_display_type = 'ARROWS'
        context.collection.objects.link(added)
        marks.write(added, self.kind)
        if self.kind == 'CELL':
            show_as_cell(added)
            added.scale = CELL_SIZE
        for found in context.selected_objects:
            found.select_set(False)
        added.select_set(True)
        context.view_layer.objects.active = added
        return {'FINISHED'}


CLASSES = (SIGHTCELL_OT_mark, SIGHTCELL_OT_clear_marks, SIGHTCELL_OT_add)
