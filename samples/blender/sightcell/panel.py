"""The panels in the sidebar of the 3D viewport."""
import bpy

from . import marks, messages, overlay, program, state

CHARACTER, BESIDE = 7, 70  # width in pixels: of a character in the mean, of icons and borders


class SightcellPanel:
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'
    bl_category = 'Sightcell'


def wrapped(context, layout, text, icon):
    """A label of several lines: those of Blender do not break."""
    scale = context.preferences.system.ui_scale
    width = max(10, int((context.region.width / scale - BESIDE) / CHARACTER))
    column, line, first = layout.column(align=True), '', True
    for word in text.split() + [None]:
        if word is not None and len(line) + len(word) < width:
            line += (' ' if line else '') + word
            continue
        if line:
            column.label(text=line, icon=icon if first else 'BLANK1')
            first = False
        line = word


class SIGHTCELL_PT_marks(SightcellPanel, bpy.types.Panel):
    bl_label = 'Marks'

    def draw(self, context):
        layout, active = self.layout, context.active_object
        if active is not None and active.select_get():
            wrapped(context, layout, f'{active.name}: {marks.describe(active)}', icon='OBJECT_DATA')
        else:
            layout.label(text='Select objects to mark', icon='INFO')
        grid = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
        for kind, name, _, _ in marks.KINDS:
            if kind != 'GROUP':
                grid.operator('sightcell.mark', text=name).kind = kind
        grid.operator('sightcell.clear_marks')
        row = layout.row(align=True)
        row.prop(state.settings(context.scene), 'group', text='')
        row.operator('sightcell.mark', text='Door').kind = 'GROUP'
        row = layout.row(align=True)
        row.operator('sightcell.add', text='Add start').kind = 'START'
        row.operator('sightcell.add', text='Add cell box').kind = 'CELL'


class SIGHTCELL_PT_bake(SightcellPanel, bpy.types.Panel):
    bl_label = 'Bake'

    def draw(self, context):
        layout, settings = self.layout, state.settings(context.scene)
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.enabled = state.job is None
        for name in ('output', 'quality', 'objects', 'cell_limit', 'options'):
            column.prop(settings, name)
        column.use_property_split = False
        column.prop(settings, 'keep_records')
        if state.job is None:
            row = layout.row()
            row.scale_y = 1.4
            row.operator('sightcell.bake', icon='RENDER_STILL')
        else:
            self.draw_progress(context)
        if state.summary:
            wrapped(context, layout, state.summary, icon='INFO')

    def draw_progress(self, context):
        layout, job = self.layout, state.job
        text = 'Stopping' if job.canceled else program.text_of(job.progress)
        row = layout.row(align=True)
        if hasattr(row, 'progress'):  # since version 4.0
            row.progress(factor=program.share_of(job.progress), text=text)
        else:
            row.prop(context.window_manager, 'sightcell_progress', text='', slider=True)
        row.operator('sightcell.cancel_bake', text='', icon='X')
        if not hasattr(row, 'progress'):
            layout.label(text=text)


class SIGHTCELL_PT_result(SightcellPanel, bpy.types.Panel):
    bl_label = 'Result'

    def draw(self, context):
        layout, settings = self.layout, state.settings(context.scene)
        row = layout.row()
        row.prop(settings, 'show_cells')
        row.prop(settings, 'color_by', text='')
        shown = overlay.geometry()
        if settings.show_cells and shown is not None and shown.lowest is not None:
            form = (lambda value: f'{value:.1e}') if settings.color_by == 'BOUND' else (lambda value: f'{value:,.0f}')
            row = layout.row()
            row.label(text=form(shown.lowest), icon='COLORSET_04_VEC')
            row.label(text=form(shown.highest), icon='COLORSET_01_VEC')
        column = layout.column(align=True)
        column.label(text='Freeze the cell of', icon='FREEZE')
        row = column.row(align=True)
        for source, name in (('CURSOR', 'Cursor'), ('CAMERA', 'Camera'), ('VIEW', 'View')):
            row.operator('sightcell.freeze', text=name).source = source
        if settings.frozen_text:
            wrapped(context, layout, settings.frozen_text, icon='HIDE_OFF')
            layout.operator('sightcell.unfreeze', icon='LOOP_BACK')
        layout.operator('sightcell.select_unseen', icon='RESTRICT_SELECT_OFF')


class SIGHTCELL_PT_messages(SightcellPanel, bpy.types.Panel):
    bl_label = 'Messages'

    @classmethod
    def poll(cls, context):
        return bool(state.messages)

    def draw(self, context):
        for message in state.messages:
            row = self.layout.row()
            wrapped(context, row, message.text, icon='CANCEL' if message.kind == messages.ERROR else 'ERROR')
            if message.object_name:
                row.operator('sightcell.select_object', text='', icon='RESTRICT_SELECT_OFF').name = message.object_name


CLASSES = (SIGHTCELL_PT_marks, SIGHTCELL_PT_bake, SIGHTCELL_PT_result, SIGHTCELL_PT_messages)
