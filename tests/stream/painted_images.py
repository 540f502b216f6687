"""Images of the painted room, as PNG files: colors, leaves with an alpha test, normals, and a damaged one. In each, the
pixels of an area differ so much that wrong means of them are found."""
import struct
import zlib

import numpy as np

PIXELS = 256  # width and height
CUTOFF = 0.4  # of the leaves


def png(pixels):
    """pixels: bytes [height, width, 3 or 4]"""
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    height, width, channels = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1).tobytes()
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)) +
            chunk(b'IDAT', zlib.compress(rows, 1)) + chunk(b'IEND', b''))


def places():
    """x and y of pixels, 0 to 1."""
    return np.meshgrid(*[np.linspace(0, 1, PIXELS)] * 2)


def colors():
    """Half of the pixels are black: means of light are much lighter than those of numbers."""
    x, y = places()
    checker = np.indices((PIXELS, PIXELS)).sum(axis=0) % 2
    noise = np.random.default_rng(1).integers(0, 4, (PIXELS, PIXELS, 3))
    return ((np.stack([90 + 150 * x, 90 + 150 * y, 240 - 150 * x], axis=2) + noise) * checker[:, :, None]).astype(np.uint8)


def leaves():
    """Three of ten pixels are green and opaque, the others red and transparent: the mean alpha passes nearly nowhere."""
    opaque = np.random.default_rng(2).random((PIXELS, PIXELS)) < 0.3
    return np.where(opaque[:, :, None], [30, 160, 40, 255], [200, 0, 0, 0]).astype(np.uint8)


def normals():
    """Turned to and fro from pixel to pixel: the mean is short."""
    x, y = places()
    turn = 0.8 * (np.indices((PIXELS, PIXELS))[1] % 2 * 2 - 1) + 0.4 * (x - 0.5)
    tilt = 0.5 * (y - 0.5)
    vectors = np.stack([np.sin(turn), np.cos(turn) * np.sin(tilt), np.cos(turn) * np.cos(tilt)], axis=2)
    return np.rint(127.5 + 127.5 * vectors).astype(np.uint8)


def damaged():
    return png(colors())[:2000]


def light_of(numbers):
    share = np.asarray(numbers, 'f8') / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def numbers_of(light):
    return 255 * np.where(light <= 0.0031308, light * 12.92, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)


def means(values, side):
    """Of equal squares; values: [PIXELS, PIXELS, ...]"""
    step = PIXELS // side
    return values.reshape(side, step, side, step, *values.shape[2:]).mean(axis=(1, 3))
