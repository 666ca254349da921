"""Recognition messages in the recordings that `wirepose record` writes (MCAP, not compressed)."""
import struct

CHANNEL, MESSAGE, CHUNK, DATA_END = 0x04, 0x05, 0x06, 0x0F


def records(data, at=0):
    """(opcode, content) one by one."""
    while at + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if opcode == DATA_END:
            return
        yield opcode, data[at + 9:at + 9 + length]
        at += 9 + length


def text(content, at):
    length = struct.unpack_from("<I", content, at)[0]
    return content[at + 4:at + 4 + length].decode(), at + 4 + length


def messages(file, topic):
    """CDR of every message on a topic, encapsulation header first, in the order of arrival."""
    wanted = set()
    for opcode, content in records(file.read_bytes(), 8):
        if opcode == CHANNEL and text(content, 4)[0] == topic:
            wanted.add(struct.unpack_from("<H", content)[0])
        if opcode == CHUNK:
            _, at = text(content, 28)  # compression: none
            for inner, message in records(content[at + 8:]):
                if inner == MESSAGE and struct.unpack_from("<H", message)[0] in wanted:
                    yield message[22:]


def recognition(message):
    """Sequence number of the frame, and all bytes that depend on the images alone: without sequence, times, and the
    count of results that were dropped before."""
    header, sequence = struct.unpack_from("<IQ", message)
    assert header == 0x0100, "little-endian plain CDR"
    return sequence, message[4 + 24:-8]
