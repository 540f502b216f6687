"""The operators that bake: export, run the program in the background, take in its result."""
import atexit
import os
import re
import shlex
import time

import bpy

from . import freeze, messages, overlay, program, scene_file, state
from .problem import Problem

PAUSE = 0.2  # seconds between two polls of the running program
SHOWN = 20  # messages in the panel
OTHER_BAKE, OTHER_RECORDS = '[checkpoint.other-bake]', '[records.'  # in errors that another command avoids


def export_scene(path, objects):
    """Exports the scene as Blender's File > Export does. Options that a version of the exporter lacks are left out."""
    options = {'filepath': path, 'export_format': 'GLB', 'export_extras': True, 'export_yup': True,
               'export_apply': True, 'use_active_scene': True, 'use_renderable': objects == 'RENDERABLE',
               'use_visible': objects == 'VISIBLE', 'use_selection': False, 'use_active_collection': False,
               'export_cameras': False, 'export_lights': False, 'export_gpu_instances': False,
               'export_draco_mesh_compression_enable': False, 'will_save_settings': False, 'check_existing': False}
    modes = leave_modes()
    try:
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
        bpy.ops.export_scene.gltf(**{name: value for name, value in options.items() if name in known})
    except (AttributeError, KeyError):
        raise Problem('enable the add-on "glTF 2.0 format": it exports the scene') from None
    except RuntimeError as problem:
        raise Problem(f'the export failed: {cause_of(problem)}') from None
    finally:
        set_modes(*modes)
    if not os.path.exists(path):
        raise Problem(f'{path}: the export wrote nothing; choose a folder that can be written')


def leave_modes():
    """Ends edit modes: what is being edited is not in the mesh yet, and the exporter ends only that of the active
    object. Returns the arguments of set_modes() that bring them back."""
    objects = bpy.context.view_layer.objects
    modes = [(found, found.mode) for found in objects if found.mode != 'OBJECT'], objects.active
    set_modes([(found, 'OBJECT') for found, _ in modes[0]], modes[1])
    return modes


def set_modes(modes, active):
    objects = bpy.context.view_layer.objects
    for found, mode in modes:
        objects.active = found
        if found.mode != mode:
            bpy.ops.object.mode_set(mode=mode)
    objects.active = active


def cause_of(problem):
    """The line of a traceback that names the cause."""
    lines = [line.strip() for line in str(problem).splitlines() if line.strip()]
    named = [line for line in lines if re.match(r'[A-Za-z]*Error: ', line) and not line.startswith('Error: ')]
    return (named or lines or ['no reason given'])[-1]


class BakeSteps:
    """A bake from export to result. The exported scene takes its place together with the .pvs file, at the end."""

    def __init__(self, scene):
        settings = state.settings(scene)
        self.program, self.pvs = state.program_path(), state.output_path(scene)
        self.exported = self.pvs[:-len('.pvs')] + '.export.glb'
        if not os.path.isdir(os.path.dirname(self.pvs)):
            raise Problem(f'{os.path.dirname(self.pvs)} is not a folder: choose another one')
        self.command = [self.program, 'bake', self.exported, '-o', self.pvs, '--quality', settings.quality,
                        '--progress', 'json', '--json']
        self.since = []
        if settings.keep_records:
            self.command.append('--keep-records')
            self.since = ['--since', self.pvs] if os.path.exists(self.pvs + '.records') else []
        if settings.cell_limit:
            self.command += ['--cell-limit', str(settings.cell_limit)]
        try:
            self.command += shlex.split(settings.options)
        except ValueError:
            raise Problem(f'Options: a quote is missing in {settings.options}') from None
        state.messages.clear()
        state.summary = ''
        if settings.objects == 'VISIBLE':
            freeze.unfreeze(scene)  # hidden objects belong to the level too
        try:
            export_scene(self.exported, settings.objects)
            self.nodes = scene_file.Nodes(scene_file.read_document(self.exported), state.object_table(scene))
            self.start()
        except Problem:
            self.remove_export()
            raise

    def start(self):
        state.job = program.Job(self.command + self.since)

    def remove_export(self):
        if os.path.exists(self.exported):
            os.remove(self.exported)

    def poll(self):
        """True when the bake has ended. One that finds the checkpoint of an earlier scene, or records of another bake,
        starts again without them."""
        if not state.job.poll():
            return False
        said = '\n'.join(state.job.messages)
        if state.job.canceled or state.job.code == program.DONE:
            return True
        if self.since and OTHER_RECORDS in said:
            self.since = []
        elif OTHER_BAKE in said and '--fresh' not in self.command:
            self.command.append('--fresh')
        else:
            return True
        self.start()
        return False

    def finish(self):
        """Takes in the result: the messages, and the scene beside the .pvs file. Throws Problem if there is none."""
        job, state.job = state.job, None
        found = [messages.translate(line, self.nodes) for line in job.messages]
        state.messages[:] = [message for message in found if message is not None][:SHOWN]
        if job.code in (program.DONE, program.BOUND_NOT_MET):
            os.replace(self.exported, state.scene_path(self.pvs))
            state.summary = summary_text(job.summary)
            return
        self.remove_export()
        if job.canceled or job.code == program.CANCELED:
            state.summary = 'Canceled. The next bake of this scene continues from there'
            return
        errors = [message for message in state.messages if message.kind == messages.ERROR]
        if not errors:
            errors = [messages.Message(messages.ERROR, (job.messages or [f'exit code {job.code}'])[-1])]
            state.messages += errors
        raise Problem(errors[-1].text)

    def abandon(self):
        """Ends a bake whose result is not wanted."""
        if state.job is not None:
            state.job.cancel()
            state.job = None
        self.remove_export()


def summary_text(summary):
    cells = summary.get('cells', 0)
    text = f"{cells:,} cells, {summary.get('visible_set_percent', 0):.1f} % of all polygons visible per cell"
    if summary.get('max_upper_bound'):
        text += f", largest bound {summary['max_upper_bound']:.1e}"
    again = summary.get('cells_rebaked')
    if again:
        text += f"; {again['cells']:,} of {cells:,} cells baked again"
    over = summary.get('cells_over_bound', 0)
    return text + (f'; {over:,} cells are above the bound' if over else '')


def show_result(scene):
    """The cells of a new bake, where cells are shown."""
    settings = state.settings(scene)
    state.forget()
    settings.frozen_cell = -1  # cells have other numbers now
    if settings.show_cells:
        overlay.prepare(state.bake(scene), settings.color_by)
    state.redraw()


class SIGHTCELL_OT_bake(bpy.types.Operator):
    bl_idname = 'sightcell.bake'
    bl_label = 'Bake'
    bl_description = 'Export the scene and compute what is visible from each cell. You can go on working meanwhile'

    steps = None

    @classmethod
    def poll(cls, context):
        return state.job is None

    def begin(self, context):
        self.steps = BakeSteps(context.scene)

    def end(self, context):
        self.steps.finish()
        show_result(context.scene)
        level = 'WARNING' if state.messages else 'INFO'
        self.report({level}, f'Sightcell: {state.summary}')
        return {'FINISHED'}

    def failed(self, problem):
        if self.steps is not None:
            self.steps.abandon()
        if not any(message.text == str(problem) for message in state.messages):
            state.messages.append(messages.Message(messages.ERROR, str(problem)))
        state.redraw()
        self.report({'ERROR'}, str(problem))
        return {'CANCELLED'}

    def execute(self, context):
        """To its end: for scripts, and for Blender without a window."""
        try:
            self.begin(context)
            while not self.steps.poll():
                time.sleep(PAUSE / 4)
            return self.end(context)
        except Problem as problem:
            return self.failed(problem)

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.begin(context)
        except Problem as problem:
            return self.failed(problem)
        self.timer = context.window_manager.event_timer_add(PAUSE, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {'RUNNING_MODAL'}

    def modal(self, context, event):
        if event.type != 'TIMER':
            return {'PASS_THROUGH'}
        state.redraw()
        try:
            if state.job is not None and not self.steps.poll():
                return {'PASS_THROUGH'}
            result = self.end(context) if state.job is not None else {'CANCELLED'}  # none: the add-on was disabled
        except Problem as problem:
            result = self.failed(problem)
        context.window_manager.event_timer_remove(self.timer)
        return result

    def cancel(self, context):
        """Blender ends the operator: another file is opened, or Blender quits."""
        self.steps.abandon()


class SIGHTCELL_OT_cancel_bake(bpy.types.Operator):
    bl_idname = 'sightcell.cancel_bake'
    bl_label = 'Cancel'
    bl_description = ('Stop the bake. An older result stays as it is, and the next bake of this scene continues from '
                      'here')

    @classmethod
    def poll(cls, context):
        return state.job is not None

    def execute(self, context):
        state.job.cancel()
        return {'FINISHED'}


def stop():
    """Ends a running bake with Blender."""
    if state.job is not None:
        state.job.cancel()
        state.job = None


atexit.register(stop)
CLASSES = (SIGHTCELL_OT_bake, SIGHTCELL_OT_cancel_bake)
