"""The picture of Xvfb, which writes it as Xvfb_screen0 to its -fbdir."""
import os
import struct

import numpy


def pixels(folder):
    """(rows, columns, 3), red first."""
    with open(os.path.join(folder, 'Xvfb_screen0'), 'rb') as file:
        screen = file.read()
    header = struct.unpack('>25I', screen[:100])  # XWDFileHeader
    size, height, line, colors = header[0], header[5], header[12], header[19]
    if (header[11], header[7]) != (32, 0):
        raise ValueError('not 32 bits per pixel, least significant byte first')
    begin = size + 12 * colors
    return numpy.frombuffer(screen[begin:begin + height * line], numpy.uint8).reshape(height, line // 4, 4)[..., 2::-1]
