"""A USB camera that plays given grey images: video class 1.0, one bulk endpoint, YUYV and 8 bit grey.

Cameras do not run by themselves: a Shutter exposes one frame on all of them at once, as a trigger line does.
"""
import asyncio
import collections
import struct
import time

import usb_redirection as usb

BULK_IN = 0x81
PACKET_BYTES = 512
PAYLOAD_BYTES = 16384  # of one transfer, with its header
FORMATS = {1: ("YUYV", b"YUY2\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71", 2),
           2: ("R8", b"Y800\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71", 1)}  # index: name, GUID, bytes a pixel
# Requests of the video class, and the two controls of a streaming interface.
SET_CUR, GET_LEN, GET_INFO = 0x01, 0x85, 0x86
PROBE, COMMIT = 1, 2
PROBE_BYTES = 26


def text_descriptor(text):
    return struct.pack("BB", 2 + 2 * len(text), 3) + text.encode("utf-16-le")


def streaming_descriptors(width, height, frame_rate_hz):
    """What the streaming interface can give: each format in one size and at one rate."""
    interval = round(1e7 / frame_rate_hz)  # in 100 ns
    formats = b""
    for index, (_, guid, pixel_bytes) in FORMATS.items():
        size = width * height * pixel_bytes
        formats += struct.pack("<BBBBB16sBBBBBB", 27, 0x24, 4, index, 1, guid, 8 * pixel_bytes, 1, 0, 0, 0, 0)
        formats += struct.pack("<BBBBBHHIIIIBI", 30, 0x24, 5, 1, 0, width, height, round(8 * size * frame_rate_hz),
                               round(8 * size * frame_rate_hz), size, interval, 1, interval)
    count = len(FORMATS)
    header = struct.pack("<BBBBHBBBBBBB", 13 + count, 0x24, 1, count, 13 + count + len(formats), BULK_IN, 0, 2, 0, 0, 0,
                         1) + bytes(count)
    return header + formats


def configuration_descriptor(width, height, frame_rate_hz):
    control = struct.pack("<BBBHHIBB", 13, 0x24, 1, 0x0100, 40, 30_000_000, 1, 1)  # version 1.0, 30 MHz clock
    control += struct.pack("<BBBBHBBHHHBH", 18, 0x24, 2, 1, 0x0201, 0, 0, 0, 0, 0, 3, 0) + b"\0"  # camera terminal
    control += struct.pack("<BBBBHBBB", 9, 0x24, 3, 2, 0x0101, 0, 1, 0)  # output terminal, fed by the camera
    body = struct.pack("BBBBBBBB", 8, 11, 0, 2, 0x0E, 3, 0, 0)  # both interfaces are one function
    body += struct.pack("BBBBBBBBB", 9, 4, 0, 0, 0, 0x0E, 1, 0, 0) + control
    body += struct.pack("BBBBBBBBB", 9, 4, 1, 0, 1, 0x0E, 2, 0, 0) + streaming_descriptors(width, height, frame_rate_hz)
    body += struct.pack("<BBBBHB", 7, 5, BULK_IN, 2, PACKET_BYTES, 0)
    return struct.pack("<BBHBBBBB", 9, 2, 9 + len(body), 2, 1, 0, 0x80, 50) + body


class UsbCamera:
    """`name` is the product's name, `frames` the images, each width * height bytes."""

    def __init__(self, name, serial, size, frame_rate_hz, frames):
        self.frames = frames
        self._texts = {1: "Wirepose", 2: name, 3: serial}
        self._size, self._rate = size, frame_rate_hz
        self._configuration = configuration_descriptor(*size, frame_rate_hz)
        self._connection, self._task = None, None
        self._format = 1
        self._wanted = collections.deque()  # transfers that wait for data: id, length
        self._asked = asyncio.Event()
        self._frame_id = 0
        self.frames_sent = 0

    async def plug(self, path):
        self._connection = await usb.Connection.open(path)
        self._connection.describe([(0x0E, 1, 0), (0x0E, 2, 0)], (BULK_IN, 1), PACKET_BYTES, (0x1D6B, 0x0104))
        self._task = asyncio.create_task(self._serve())

    def unplug(self):
        if self._connection:
            self._connection.close()
            self._task.cancel()
        self._connection = None
        self._wanted.clear()

    @property
    def streaming(self):
        return self._connection is not None and bool(self._wanted)

    async def expose(self, number):
        """Sends frame `number`, counted round. Gives up when the host stops to ask for data: the frame ends short."""
        pixels = self.frames[number % len(self.frames)]
        if FORMATS[self._format][2] == 2:
            packed = bytearray(b"\x80" * (2 * len(pixels)))
            packed[::2] = pixels
            pixels = bytes(packed)
        self._frame_id ^= 1
        sent = 0
        while sent < len(pixels):
            transfer = await self._next_transfer()
            if transfer is None:
                return
            ident, room = transfer
            part = pixels[sent:sent + min(room, PAYLOAD_BYTES) - 2]
            sent += len(part)
            last = 2 if sent == len(pixels) else 0
            self._answer_bulk(ident, usb.SUCCESS, bytes((2, 0x80 | last | self._frame_id)) + part)
        self.frames_sent += 1

    async def _next_transfer(self):
        end = time.monotonic() + 1
        while not self._wanted:
            self._asked.clear()
            try:
                await asyncio.wait_for(self._asked.wait(), end - time.monotonic())
            except asyncio.TimeoutError:
                return None
        return self._wanted.popleft()

    async def _serve(self):
        try:
            while True:
                self._handle(*await self._connection.receive())
        except (asyncio.IncompleteReadError, ConnectionError):
            self._wanted.clear()

    def _handle(self, kind, ident, body):
        if kind == usb.CONTROL_PACKET:
            self._control(ident, body)
        elif kind == usb.BULK_PACKET:
            _, _, low, _, high = usb.BULK.unpack_from(body)
            self._wanted.append((ident, high << 16 | low))
            self._asked.set()
        elif kind == usb.CANCEL_DATA_PACKET:
            self._cancel(ident)
        elif kind == usb.SET_CONFIGURATION:
            self._connection.send(usb.CONFIGURATION_STATUS, ident, bytes((usb.SUCCESS, body[0])))
        elif kind == usb.GET_CONFIGURATION:
            self._connection.send(usb.CONFIGURATION_STATUS, ident, bytes((usb.SUCCESS, 1)))
        elif kind in (usb.SET_ALT_SETTING, usb.GET_ALT_SETTING):
            self._connection.send(usb.ALT_SETTING_STATUS, ident, bytes((usb.SUCCESS, body[0], 0)))
        elif kind == usb.RESET:
            self._wanted.clear()

    def _cancel(self, ident):
        for transfer in self._wanted:
            if transfer[0] == ident:
                self._wanted.remove(transfer)
                self._answer_bulk(ident, usb.CANCELLED, b"")
                return

    def _answer_bulk(self, ident, status, data):
        if self._connection:
            header = usb.BULK.pack(BULK_IN, status, len(data) & 0xFFFF, 0, len(data) >> 16)
            self._connection.send(usb.BULK_PACKET, ident, header + data)

    def _control(self, ident, body):
        endpoint, request, request_type, _, value, index, length = usb.CONTROL.unpack_from(body)
        given = body[usb.CONTROL.size:]
        standard = request_type & 0x60 == 0
        answer = self._standard(request, value) if standard else self._video(request, value, given)
        status = usb.STALL if answer is None else usb.SUCCESS
        data = (answer or b"")[:length] if request_type & 0x80 else b""
        count = len(data) if request_type & 0x80 else len(given)
        header = usb.CONTROL.pack(endpoint, request, request_type, status, value, index, count)
        self._connection.send(usb.CONTROL_PACKET, ident, header + data)

    def _standard(self, request, value):
        """Data of a standard request; None for one that the device does not have."""
        get_status, get_descriptor = 0, 6
        if request == get_status:
            return b"\0\0"
        if request != get_descriptor:
            return b"" if request == 1 else None  # CLEAR_FEATURE: an endpoint that was halted
        kind, number = value >> 8, value & 0xFF
        if kind == 1:
            return struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0200, 0xEF, 2, 1, 64, 0x1D6B, 0x0104, 0x0100, 1, 2, 3, 1)
        if kind == 2:
            return self._configuration
        if kind == 3:
            return struct.pack("<BBH", 4, 3, 0x0409) if number == 0 else text_descriptor(self._texts.get(number, ""))
        return None

    def _video(self, request, value, given):
        """Data of a request of the video class: negotiation of format, nothing else is adjustable."""
        control = value >> 8
        if control not in (PROBE, COMMIT):
            return None
        if request == SET_CUR:
            self._format = given[2] if len(given) > 2 and given[2] in FORMATS else 1
            return b""
        if request == GET_LEN:
            return struct.pack("<H", PROBE_BYTES)
        if request == GET_INFO:
            return b"\x03"
        size = self._size[0] * self._size[1] * FORMATS[self._format][2]
        return struct.pack("<HBBIHHHHHII", 0, self._format, 1, round(1e7 / self._rate), 0, 0, 0, 0, 0, size, PAYLOAD_BYTES)


class Shutter:
    """Exposes the same frame number on all cameras that stream, at the frame rate or as fast as they can be read."""

    def __init__(self, cameras, frame_rate_hz):
        self._cameras, self._period_s = cameras, 1 / frame_rate_hz
        self.number = 0

    async def run(self):
        while True:
            began = time.monotonic()
            await asyncio.gather(*(c.expose(self.number) for c in self._cameras if c.streaming))
            self.number += 1
            await asyncio.sleep(max(0, self._period_s - (time.monotonic() - began)))
