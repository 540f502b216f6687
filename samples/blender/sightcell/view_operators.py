"""Operators that show what cells see: freeze, unfreeze, select what no cell sees."""
import bpy
from bpy.props import EnumProperty, StringProperty
from mathutils import Vector

from . import freeze, state
from .problem import Problem

EYE_HEIGHT = 1.7  # meters: of a player on the floor where the 3D cursor is


def eye_points(context, source):
    """Where to look from, best first."""
    if source == 'CAMERA':
        if context.scene.camera is None:
            raise Problem('the scene has no camera')
        return [context.scene.camera.matrix_world.translation]
    if source == 'VIEW':
        region = getattr(context.space_data, 'region_3d', None)
        if region is None:
            raise Problem('use this in a 3D viewport')
        return [region.view_matrix.inverted().translation]
    cursor = context.scene.cursor.location
    return [cursor, cursor + Vector((0, 0, EYE_HEIGHT))]


class SIGHTCELL_OT_freeze(bpy.types.Operator):
    bl_idname = 'sightcell.freeze'
    bl_label = 'Freeze this cell'
    bl_description = 'Hide the objects that are not visible from the cell'
    bl_options = {'REGISTER', 'UNDO'}

    source: EnumProperty(
        name='From', items=[('CURSOR', '3D cursor', 'The cell of the 3D cursor, or of a player there'),
                            ('CAMERA', 'Camera', 'The cell of the camera of the scene'),
                            ('VIEW', 'This view', 'The cell from which this viewport shows the scene')])

    @classmethod
    def description(cls, context, properties):
        where = {'CURSOR': 'of the 3D cursor (a cursor on a floor counts as a player there)',
                 'CAMERA': 'of the camera of the scene', 'VIEW': 'in which you are with this viewport'}
        return (f'Hide the objects that are not visible from the cell {where[properties.source]}. '
                'Objects of which any polygon is visible stay whole')

    def execute(self, context):
        context.view_layer.update()  # in a script, its objects may be those of before
        try:
            bake = state.bake(context.scene)
            sights = [bake.at(point) for point in eye_points(context, self.source)]
            sight = next((found for found in sights if found.cell is not None and found.nodes is not None), None)
            if sight is None:
                raise Problem('this place is in no cell: the game draws everything there')
        except Problem as problem:
            self.report({'ERROR'}, str(problem))
            return {'CANCELLED'}
        freeze.unfreeze(context.scene)
        freeze.hide(context.scene, context.view_layer, bake, sight)
        self.report({'INFO'}, state.settings(context.scene).frozen_text)
        state.redraw()
        return {'FINISHED'}


class SIGHTCELL_OT_unfreeze(bpy.types.Operator):
    bl_idname = 'sightcell.unfreeze'
    bl_label = 'Unfreeze'
    bl_description = 'Show again what was hidden, and nothing else'
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return bool(state.settings(context.scene).frozen_text)

    def execute(self, context):
        freeze.unfreeze(context.scene)
        state.redraw()
        return {'FINISHED'}


class SIGHTCELL_OT_select_unseen(bpy.types.Operator):
    bl_idname = 'sightcell.select_unseen'
    bl_label = 'Select what no cell sees'
    bl_description = ('Select objects of which no polygon is visible from any cell. Shadows, mirrors and collision may '
                      'still need them')
    bl_options = {'REGISTER', 'UNDO'}

    def execute(self, context):
        context.view_layer.update()  # in a script, its objects may be those of before
        try:
            bake = state.bake(context.scene)
        except Problem as problem:
            self.report({'ERROR'}, str(problem))
            return {'CANCELLED'}
        seen, described = bake.split(bake.seen)
        unseen = described - seen - {bake.nodes.owners[node] for node in bake.nodes.never}
        selected = hidden = 0
        for found in context.view_layer.objects:
            wanted = found.name in unseen
            hidden += wanted and not found.visible_get()
            found.select_set(wanted and found.visible_get())
            if found.select_get():
                selected += 1
                context.view_layer.objects.active = found
        more = f'; {hidden} more are hidden in the viewport' if hidden else ''
        self.report({'INFO'}, f'{selected} objects that no cell sees{more}')
        return {'FINISHED'}


class SIGHTCELL_OT_select_object(bpy.types.Operator):
    bl_idname = 'sightcell.select_object'
    bl_label = 'Select'
    bl_description = 'Select the object that the message is about'
    bl_options = {'REGISTER', 'UNDO'}

    name: StringProperty()

    def execute(self, context):
        wanted = context.view_layer.objects.get(self.name)
        if wanted is None:
            self.report({'WARNING'}, f'"{self.name}" is not in this view layer')
            return {'CANCELLED'}
        for found in context.view_layer.objects:
            found.select_set(found is wanted or found == wanted)
        context.view_layer.objects.active = wanted
        return {'FINISHED'}


CLASSES = (SIGHTCELL_OT_freeze, SIGHTCELL_OT_unfreeze, SIGHTCELL_OT_select_unseen, SIGHTCELL_OT_select_object)
