"""What .pvs files are made of: checksums, bits, packed columns, prefix codes. Written from format/SPEC.md alone."""
import struct

MASK32 = 0xFFFFFFFF
PADDING = 8  # zero bytes behind bits
LONGEST_CODE = 15


class Refused(ValueError):
    """The file breaks a rule. status: its name, as SPEC.md and status.h have it."""

    def __init__(self, status, what):
        super().__init__(f"{status}: {what}")
        self.status = status


def need(condition, what, status="corrupt"):
    if not condition:
        raise Refused(status, what)


def crc_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte >> 1) ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


CRC_TABLE = crc_table()


def crc32c(data):
    crc = MASK32
    for byte in data:
        crc = (crc >> 8) ^ CRC_TABLE[(crc ^ byte) & 0xFF]
    return crc ^ MASK32


def unpack(form, data, at, what):
    need(at + struct.calcsize(form) <= len(data), f"{what} is cut")
    return struct.unpack_from(form, data, at)


class Bits:
    """Bits of a string of bytes from one place, in bits, up to another."""

    def __init__(self, data, at, end):
        self.data, self.at, self.end = data, at, end

    def peek(self, count):
        """The next bits as a number; zeros behind the end of the bytes."""
        value = int.from_bytes(self.data[self.at >> 3:(self.at + count + 7) >> 3], "little") >> (self.at & 7)
        return value & ((1 << count) - 1)

    def take(self, count):
        value = self.peek(count)
        self.skip(count)
        return value

    def skip(self, count):
        self.at += count
        need(self.at <= self.end, "bits run out")


def packed_columns(data, at, columns, rows):
    """The columns as lists, and where the table ends."""
    descriptors = [unpack("<II", data, at + 8 * i, "packed columns") for i in range(columns)]
    at += 8 * columns
    need(all(bits <= 32 for _, bits in descriptors), "a column has more than 32 bits")
    need(at + sum((bits * rows + 7) // 8 for _, bits in descriptors) <= len(data), "packed columns are cut")
    values = []
    for smallest, width in descriptors:
        end = at + (width * rows + 7) // 8
        bits = Bits(data, 8 * at, 8 * end)
        values.append([(smallest + bits.take(width)) & MASK32 for _ in range(rows)])
        at = end
    return values, at


class PrefixCode:
    """Numbers by one code table: a symbol's code, then raw bits."""

    def __init__(self, lengths):
        used = [length for length in lengths if length > 0]
        complete = sum(1 << (LONGEST_CODE - length) for length in used) == 1 << LONGEST_CODE
        need(complete or used in ([], [1]), "codes are not complete")
        # By the next 15 bits: the symbol and how many of the bits are its code.
        self.symbols = [None] * (1 << LONGEST_CODE)
        code = 0
        for length in range(1, LONGEST_CODE + 1):
            for symbol, its_length in enumerate(lengths):
                if its_length == length:
                    first_bit_lowest = int(f"{code:0{length}b}"[::-1], 2)
                    self.symbols[first_bit_lowest::1 << length] = [(symbol, length)] * (1 << (LONGEST_CODE - length))
                    code += 1
            code <<= 1

    def symbol(self, bits):
        found = self.symbols[bits.peek(LONGEST_CODE)]
        need(found is not None, "bits are no code")
        bits.skip(found[1])
        return found[0]

    def number(self, bits):
        return with_raw_bits(self.symbol(bits), bits)


def with_raw_bits(symbol, bits):
    if symbol < 4:
        return symbol
    count = (symbol - 4) // 2 + 1
    return (2 + symbol % 2) << count | bits.take(count)


def code_table(data, at, symbols=64, longest=LONGEST_CODE):
    """The code, and where its table ends. Only so many symbols have codes, of so many bits at most."""
    count = unpack("<B", data, at, "code table")[0]
    need(count <= 64, "a code table of more than 64 symbols")
    end = at + 1 + (count + 1) // 2
    need(end <= len(data), "code table is cut")
    bits = Bits(data, 8 * (at + 1), 8 * end)
    lengths = [bits.take(4) for _ in range(count)]
    need(not any(lengths[symbols:]) and max(lengths, default=0) <= longest, "a code that its table may not have")
    return PrefixCode(lengths), end
