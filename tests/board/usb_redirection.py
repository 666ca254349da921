"""The device's side of USB network redirection (usbredir 0.7): QEMU's `usb-redir` is the host controller's side.

A connected socket is a plugged cable, a closed one a pulled cable. All integers are little-endian.
"""
import asyncio
import struct

# Packets that are used here.
HELLO, DEVICE_CONNECT, RESET, INTERFACE_INFO, EP_INFO = 0, 1, 3, 4, 5
SET_CONFIGURATION, GET_CONFIGURATION, CONFIGURATION_STATUS = 6, 7, 8
SET_ALT_SETTING, GET_ALT_SETTING, ALT_SETTING_STATUS = 9, 10, 11
CANCEL_DATA_PACKET = 21
CONTROL_PACKET, BULK_PACKET = 100, 101

SUCCESS, CANCELLED, STALL = 0, 1, 4
TYPE_CONTROL, TYPE_BULK, TYPE_INVALID = 0, 2, 255
SPEED_HIGH = 2
# Capabilities: device version, packet sizes of endpoints, 64 bit ids, 32 bit lengths of bulk packets.
CAPABILITIES = 1 << 1 | 1 << 4 | 1 << 5 | 1 << 6

CONTROL = struct.Struct("<BBBBHHH")  # endpoint request requesttype status value index length
BULK = struct.Struct("<BBHIH")  # endpoint status length stream length_high


class Connection:
    """A socket that carries packets. One task reads; sending is not blocked by it."""

    def __init__(self, reader, writer):
        self.reader, self.writer = reader, writer
        self._header = struct.Struct("<IIQ")

    @classmethod
    async def open(cls, path):
        """Plugs the device in: exchanges greetings with the QEMU that listens on the UNIX socket `path`."""
        self = cls(*await asyncio.open_unix_connection(path))
        greeting = struct.Struct("<III")  # ids have 32 bits until both know each other's capabilities
        body = b"wirepose board test".ljust(64, b"\0") + struct.pack("<I", CAPABILITIES)
        self.writer.write(greeting.pack(HELLO, len(body), 0) + body)
        kind, length, _ = greeting.unpack(await self.reader.readexactly(greeting.size))
        theirs = await self.reader.readexactly(length)
        if kind != HELLO or struct.unpack_from("<I", theirs, 64)[0] & CAPABILITIES != CAPABILITIES:
            raise ConnectionError(f"{path}: this QEMU speaks an older usbredir; 7.2 is known to work")
        return self

    def send(self, kind, ident, body):
        self.writer.write(self._header.pack(kind, len(body), ident) + body)

    async def receive(self):
        """The next packet: kind, id, body. IncompleteReadError when the other side has gone."""
        kind, length, ident = self._header.unpack(await self.reader.readexactly(self._header.size))
        return kind, ident, await self.reader.readexactly(length)

    def close(self):
        self.writer.close()

    def describe(self, interfaces, bulk_in, packet_bytes, ids):
        """Tells what the device is: (class, subclass, protocol) of each interface, its one bulk IN endpoint as (address,
        interface), the endpoint's packet size, (vendor, product)."""
        def table(values):
            return bytes(values).ljust(32, b"\0")

        self.send(INTERFACE_INFO, 0, struct.pack("<I", len(interfaces)) + table(range(len(interfaces))) +
                  b"".join(table(i[field] for i in interfaces) for field in range(3)))
        kinds, owners, sizes = [TYPE_INVALID] * 32, [0] * 32, [0] * 32
        kinds[0] = kinds[16] = TYPE_CONTROL
        sizes[0] = sizes[16] = 64
        at = 16 + (bulk_in[0] & 15)
        kinds[at], owners[at], sizes[at] = TYPE_BULK, bulk_in[1], packet_bytes
        self.send(EP_INFO, 0, bytes(kinds) + bytes(32) + bytes(owners) + struct.pack("<32H", *sizes))
        # 0xEF 2 1: a device whose interfaces belong together.
        self.send(DEVICE_CONNECT, 0, struct.pack("<BBBBHHH", SPEED_HIGH, 0xEF, 2, 1, *ids, 0x0100))
