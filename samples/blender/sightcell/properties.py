"""Settings of a scene, and the preferences of the add-on."""
import bpy
from bpy.app.handlers import persistent
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty,
                       StringProperty)

from . import overlay, program, state
from .marks import SETTINGS
from .messages import ERROR, Message
from .problem import Problem


class SightcellPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(
        name='Program', subtype='FILE_PATH',
        description='The program "sightcell", or the folder of a bundle. Empty: the one in PATH')

    def draw(self, context):
        self.layout.prop(self, 'program')
        try:
            self.layout.label(text=f'Found: {state.program_path()}', icon='CHECKMARK')
        except Problem as problem:
            self.layout.label(text=str(problem), icon='ERROR')


class SightcellFrozenObject(bpy.types.PropertyGroup):
    target: PointerProperty(type=bpy.types.Object)
    selected: BoolProperty()


def show_cells_changed(self, context):
    if self.show_cells:
        try:
            overlay.prepare(state.bake(context.scene), self.color_by)
        except Problem as problem:
            state.messages[:] = [Message(ERROR, str(problem))]
            self.show_cells = False
            return
    state.redraw()


class SightcellSettings(bpy.types.PropertyGroup):
    group: StringProperty(
        name='Name', default='door', description='Name by which the game opens and closes the selected objects')
    output: StringProperty(
        name='File', subtype='FILE_PATH',
        description='The .pvs file that the bake writes, with the exported scene (.glb) beside it. Empty: beside the '
                    '.blend file, with its name')
    quality: EnumProperty(
        name='Quality', default='draft', description='How certain it is that nothing visible is missing',
        items=[('draft', 'Draft', 'For trials while the level changes: at most 1 of 1,000 pixels is wrong'),
               ('normal', 'Normal', 'For builds that people play: at most 1 of 10,000 pixels is wrong'),
               ('final', 'Final', 'For the release: at most 1 of 100,000 pixels is wrong')])
    cell_limit: IntProperty(
        name='Cells', min=0, soft_max=1000,
        description='Bake only some cells, spread over the level, to try things out. 0: all cells')
    keep_records: BoolProperty(
        name='Quick re-bakes',
        description='After an edit, bake only the cells that it can change. The records of a bake stay on the disk '
                    'beside the .pvs file, and may be several times its size')
    objects: EnumProperty(
        name='Objects', default='RENDERABLE', description='Which objects are exported and baked',
        items=[('RENDERABLE', 'That render', 'Objects and collections whose camera icon in the Outliner is on'),
               ('VISIBLE', 'That are shown', 'Objects that the viewport shows now'),
               ('ALL', 'All', 'All objects of this scene')])
    options: StringProperty(
        name='Options', description='More options of "sightcell bake", for example --volumes 2 or --fly 0,0,0,9,9,9')
    show_cells: BoolProperty(
        name='Show cells', update=show_cells_changed,
        description='Draw the floor and the edges of each cell in the viewport')
    color_by: EnumProperty(
        name='Color', default='POLYGONS', update=show_cells_changed, description='What the color of a cell means',
        items=[('POLYGONS', 'Polygons', 'Red cells see the most polygons: they cost most'),
               ('BOUND', 'Bound', 'Red cells have the largest bound: there, the most of the picture may be missing')])
    frozen: CollectionProperty(type=SightcellFrozenObject)
    frozen_layer: StringProperty()
    frozen_text: StringProperty()
    frozen_cell: IntProperty(default=-1)


CLASSES = (SightcellPreferences, SightcellFrozenObject, SightcellSettings)


@persistent
def file_opened(*_):
    """Another file: what is known is of the one before."""
    state.forget()
    state.messages.clear()
    state.summary = ''
    scene = bpy.context.scene
    try:
        if scene is not None and state.settings(scene).show_cells:
            overlay.prepare(state.bake(scene), state.settings(scene).color_by)
    except Problem as problem:
        state.messages[:] = [Message(ERROR, str(problem))]


def attach():
    bpy.app.handlers.load_post.append(file_opened)
    setattr(bpy.types.Scene, SETTINGS, PointerProperty(type=SightcellSettings))
    # For the bar in versions that have no layout.progress.
    bpy.types.WindowManager.sightcell_progress = FloatProperty(
        name='Progress', subtype='PERCENTAGE', min=0, max=100, description='How far the bake is',
        get=lambda manager: 100 * program.share_of(state.job.progress) if state.job else 0.0)


def detach():
    bpy.app.handlers.load_post.remove(file_opened)
    state.forget()
    delattr(bpy.types.Scene, SETTINGS)
    del bpy.types.WindowManager.sightcell_progress
