"""Drives a headless Chromium over its debugging pipe: loads a page, evaluates script, presses keys, takes pictures.

Standard library only. Raises ChromiumError with what the browser said.
"""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time


class ChromiumError(RuntimeError):
    pass


def find_chromium():
    """Path of an installed Chromium, or None."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if shutil.which(name):
            return shutil.which(name)
    return None


class Page:
    """One page in a browser of its own. Use as a context manager; `timeout_s` bounds every wait."""

    def __init__(self, program, width=1400, height=900, timeout_s=60):
        self._timeout_s = timeout_s
        self._profile = tempfile.mkdtemp(prefix="wirepose-chromium-")
        self.problems = []  # console errors, uncaught exceptions and failed or outside requests, as text
        self.requests = []
        self._start(program)
        target = self._call("Target.createTarget", {"url": "about:blank"})["targetId"]
        self._session = self._call("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.resize(width, height)

    def _start(self, program):
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        self._buffer, self._next_id, self._session = b"", 0, None

        def connect():  # the browser reads commands from 3 and writes answers to 4
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self._log = open(os.path.join(self._profile, "log"), "w+b")
        self._process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-background-networking", "--remote-debugging-pipe", "--user-data-dir=" + self._profile],
            stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log, close_fds=False, preexec_fn=connect)
        os.close(to_browser)
        os.close(from_browser)
        os.set_blocking(self._in, False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._in)
        os.close(self._out)
        self._log.close()
        shutil.rmtree(self._profile, ignore_errors=True)

    def _receive(self, deadline):
        while b"\0" not in self._buffer:
            try:
                part = os.read(self._in, 1 << 20)
                if not part:
                    raise ChromiumError("the browser ended: " + open(self._log.name, errors="replace").read()[-2000:])
                self._buffer += part
            except BlockingIOError:
                if time.monotonic() > deadline:
                    raise ChromiumError("no answer from the browser in time")
                time.sleep(0.005)
        message, self._buffer = self._buffer.split(b"\0", 1)
        return json.loads(message)

    def _note(self, event):
        method, p = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = p["exceptionDetails"]
            self.problems.append("exception: " + details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and p["type"] in ("error", "warning", "assert"):
            self.problems.append("console: " + " ".join(str(a.get("value", a)) for a in p["args"]))
        elif method == "Log.entryAdded" and p["entry"]["level"] in ("error", "warning"):
            self.problems.append("log: " + p["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(p["request"]["url"])

    def _call(self, method, parameters=None):
        self._next_id += 1
        message = {"id": self._next_id, "method": method, "params": parameters or {}}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + self._timeout_s
        while True:
            answer = self._receive(deadline)
            if answer.get("id") != self._next_id:
                self._note(answer)
                continue
            if "error" in answer:
                raise ChromiumError(f"{method}: {answer['error']['message']}")
            return answer["result"]

    def call(self, method, parameters=None):
        """A command of the page's DevTools protocol."""
        return self._call(method, parameters)

    def resize(self, width, height, dark=False):
        self.call("Emulation.setDeviceMetricsOverride",
                  {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        self.call("Emulation.setEmulatedMedia",
                  {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def load(self, url):
        self.call("Page.navigate", {"url": url})
        self.wait_for("location.href !== 'about:blank' && document.readyState === 'complete'")

    def evaluate(self, expression):
        """Value of a JavaScript expression; a promise is awaited."""
        result = self.call("Runtime.evaluate",
                           {"expression": expression, "returnByValue": True, "awaitPromise": True})
        if "exceptionDetails" in result:
            raise ChromiumError(f"{expression}: {result['exceptionDetails']['exception'].get('description')}")
        return result["result"].get("value")

    def wait_for(self, expression):
        deadline = time.monotonic() + self._timeout_s
        while not self.evaluate(expression):
            if time.monotonic() > deadline:
                raise ChromiumError("never became true: " + expression)
            time.sleep(0.02)

    def press(self, key, code=0):
        for kind in ("keyDown", "keyUp"):
            text = {"text": key} if kind == "keyDown" and len(key) == 1 else {}
            if key == "Enter" and kind == "keyDown":
                text = {"text": "\r"}
            self.call("Input.dispatchKeyEvent",
                      {"type": kind, "key": key, "windowsVirtualKeyCode": code or ord(key[0].upper()), **text})

    def click(self, selector):
        box = self.evaluate(f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
                            "e.scrollIntoView({block: 'center', behavior: 'instant'}); const b = e.getBoundingClientRect();"
                            "return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent",
                      {"type": kind, "x": box[0], "y": box[1], "button": "left", "clickCount": 1})

    def screenshot(self, file, whole=False):
        if whole:  # tall enough for all, so that what is drawn when seen is drawn
            height = self.evaluate("document.documentElement.scrollHeight")
            width = self.evaluate("innerWidth")
            self.call("Emulation.setDeviceMetricsOverride",
                      {"width": width, "height": min(height, 16000), "deviceScaleFactor": 1, "mobile": False})
            time.sleep(0.5)
        picture = self.call("Page.captureScreenshot", {"format": "png"})
        with open(file, "wb") as out:
            out.write(base64.b64decode(picture["data"]))
