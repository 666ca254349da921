"""What the host hears from the board, while it runs."""
import asyncio
import json
import time

from errors import Failed


class Listener:
    """What `wirepose watch` hears from the board."""

    def __init__(self, watch, console):
        self._watch, self._console = watch, console
        self.results, self.detections, self.state, self.health = 0, 0, "", {}
        self.states = []

    async def listen(self):
        while line := await self._watch.stdout.readline():
            message = json.loads(line)
            if message["topic"] == "recognition":
                self.results += 1
                self.detections += len(message["detections"])
            elif message["topic"] == "health":
                self.health = message
                if message["state"] != self.state:
                    self.state = message["state"]
                    self.states.append(self.state)

    async def until(self, condition, seconds, what):
        end = time.monotonic() + seconds
        while not condition():
            if "wireposed ended" in self._console.read_text(errors="replace"):
                raise Failed(f"{what}: wireposed ended before; see {self._console}")
            if time.monotonic() > end:
                raise Failed(f"{what}: not within {seconds:.0f} s; health {self.state or 'never heard'}, "
                             f"{self.health.get('last_error', '')!r}, {self.results} results; see {self._console}")
            await asyncio.sleep(0.05)
