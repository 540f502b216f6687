"""Lines of the program, in the words of a scene in Blender."""
import re

NODE = re.compile(r'\bnodes\[(\d+)\]')
CELL = re.compile(r'\bcell \d+ "([^"]*)"')
AXIS = re.compile(r'(?<= on )[xyz](?=;)')  # of the flat box of a cell
AXES = {'x': 'x', 'y': 'z', 'z': 'y'}  # of glTF: in Blender
ERROR, WARNING = 'ERROR', 'WARNING'


class Message:
    """kind: ERROR or WARNING. text: one line. object_name: the object that it is about, or None."""

    def __init__(self, kind, text, object_name=None):
        self.kind, self.text, self.object_name = kind, text, object_name


def translate(line, nodes):
    """The message of a line that the program printed, or None for a line that needs no attention.

    nodes: scene_file.Nodes, or None if the scene cannot be read.
    """
    if line.startswith('sightcell: '):
        kind, text = ERROR, line[len('sightcell: '):]
    elif line.startswith('warning: '):
        kind, text = WARNING, line[len('warning: '):]
    else:
        return None
    found = None
    if nodes is not None:
        numbers = [int(number) for number in NODE.findall(text) if int(number) < len(nodes.nodes)]
        found = next((nodes.owners[number] for number in numbers if nodes.owners[number]), None)
        text = NODE.sub(lambda match: nodes.label(int(match.group(1))), text)
        text = AXIS.sub(lambda match: AXES[match.group()], text)
        cell = CELL.search(text)
        if found is None and cell and cell.group(1) in nodes.owners:
            found = cell.group(1)
    return Message(kind, text, found)
