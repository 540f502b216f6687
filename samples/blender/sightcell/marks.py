"""Marks of objects: the custom property "sightcell", which Blender's glTF exporter writes as extras.sightcell.

docs/json-files.md of Sightcell, "Marks", describes the keys.
"""
KEY = 'sightcell'
SETTINGS = 'sightcell_settings'  # of a scene: no mark, and nothing for a glTF file

# (identifier, name, what it means, the mark): what the panel offers. An object has one of these at a time.
KINDS = [
    ('OCCLUDER', 'Occluder', 'Solid: what is behind it is not visible. Objects without a mark are occluders too; use '
     'this below a parent that is a non-occluder', {'occluder': True}),
    ('NON_OCCLUDER', 'Non-occluder', 'Visible, but things behind it stay visible. For fences, foliage and thin clutter',
     {'occluder': False}),
    ('DYNAMIC', 'Dynamic', 'The game moves or removes it. It is in no set, and blocks no line of sight',
     {'dynamic': True}),
    ('GROUP', 'Door', 'The game opens and closes it by the name beside this button. The bake treats it as open. '
     'Objects with one name open together', {'group': ''}),
    ('ALWAYS', 'Always', 'Visible from everywhere: sky, sea, distant terrain', {'always': True}),
    ('NEVER', 'Never', 'Not a part of the picture: navigation meshes, camera rigs', {'never': True}),
    ('START', 'Start', 'A player begins here. The bake finds the floors that players reach from there',
     {'start': True}),
    ('CELL', 'Cell box', 'The box around this object is a view cell: a place where the camera can be. The object '
     'itself is not drawn', {'cell': True}),
]
EXCLUSIVE = {key for kind in KINDS for key in kind[3]}  # "static" may be beside any of them
SWITCHES = (EXCLUSIVE | {'static'}) - {'group'}


def read(blender_object):
    """The mark of an object: a dictionary, empty without one; None if the property has no keys, such as a text."""
    value = blender_object.get(KEY)
    if value is None:
        return {}
    return clean(value.to_dict()) if hasattr(value, 'to_dict') else None


def clean(mark):
    """The mark with true and false where Blender stored 1 and 0: before version 4, properties have no booleans."""
    return {key: bool(value) if key in SWITCHES and value in (0, 1) else value for key, value in mark.items()}


def write(blender_object, kind, group=''):
    """Gives an object the mark of KINDS, in place of another one of these."""
    mark = {key: value for key, value in (read(blender_object) or {}).items() if key not in EXCLUSIVE}
    for identifier, _, _, added in KINDS:
        if identifier == kind:
            mark.update({key: group if key == 'group' else value for key, value in added.items()})
    blender_object[KEY] = mark


def clear(blender_object):
    """Removes the mark. True if there was one."""
    if KEY not in blender_object:
        return False
    del blender_object[KEY]
    return True


def describe(blender_object):
    """One line for the panel: the mark of an object, or of the parent that it has it from."""
    mark, owner = read(blender_object), blender_object
    while mark == {} and owner.parent is not None:
        owner = owner.parent
        mark = {key: value for key, value in (read(owner) or {}).items() if key not in ('start', 'cell')}
    if mark is None:
        return 'The property "sightcell" is not a mark: clear it'
    names = []
    for _, name, _, added in KINDS:
        for key, value in added.items():
            if key in mark and (key == 'group' or mark[key] == value):
                names.append(f'{name} "{mark[key]}"' if key == 'group' else name)
    names += sorted(f'{key}: {value}' for key, value in mark.items() if key not in EXCLUSIVE)
    if not names:
        return 'No mark: an occluder that does not move'
    return ', '.join(names) + ('' if owner is blender_object else f' (from {owner.name})')


class glTF2ExportUserExtension:
    """What Blender's exporter calls: booleans in marks, and the settings of the panel left out."""

    def gather_node_hook(self, node, blender_object, export_settings):
        mark = (node.extras or {}).get(KEY)
        if isinstance(mark, dict):
            node.extras[KEY] = clean(mark)

    def gather_scene_hook(self, scene, blender_scene, export_settings):
        if scene.extras:
            scene.extras.pop(SETTINGS, None)
            scene.extras = scene.extras or None
