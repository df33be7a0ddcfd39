# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""A headless Chromium, driven through the pipe of its DevTools protocol: for tests of pages and for their pictures.

It has a profile of its own that is gone afterwards, and no network but this machine: every other name is answered with
an address that nobody has.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import Any, Self

START_S = 30.0
ANSWER_S = 20.0
PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = (
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-first-run",
    "--disable-gpu",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
    "--font-render-hinting=none",
    "--host-resolver-rules=MAP * 0.0.0.0, EXCLUDE localhost, EXCLUDE 127.0.0.1",
)


class BrowserError(Exception):
    """Chromium is missing, ended, does not answer or says no."""


def find_browser() -> str:
    found = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if found is None:
        raise BrowserError("no chromium; right would be Debian's package chromium, which tools/setup check installs")
    return found


class Browser:
    """One browser with one page.

    `errors` collects what its console and its log complain about, `dialogs` what it asked and was told yes,
    `requests` every address that it asked for.
    """

    def __init__(self) -> None:
        self.errors: list[str] = []
        self.dialogs: list[str] = []
        self.requests: list[str] = []
        self._number = 0
        self._buffer = b""
        self._folder = tempfile.mkdtemp(prefix="elmopp-browser-")
        self._process = self._launch()
        self._session = ""
        target = self._call("Target.createTarget", {"url": "about:blank"})["targetId"]
        attached = self._call("Target.attachToTarget", {"targetId": target, "flatten": True})
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def _launch(self) -> subprocess.Popen[bytes]:
        theirs_in, self._to = os.pipe()
        self._from, theirs_out = os.pipe()
        # Chromium's own sandbox needs privileges that a container's root lacks; it opens our own pages only.
        options = [*OPTIONS, "--no-sandbox", f"--user-data-dir={self._folder}"]

        # It speaks through descriptors 3 and 4, whatever ours are called: a shell renames them.
        script = f'exec "$@" 3<&{theirs_in} 4>&{theirs_out}'
        process = subprocess.Popen(
            ["/bin/bash", "-c", script, "browser", find_browser(), *options, "about:blank"],
            pass_fds=(theirs_in, theirs_out),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(theirs_in)
        os.close(theirs_out)
        return process

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        os.close(self._to)  # the end of its pipe ends it
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._from)
        shutil.rmtree(self._folder, ignore_errors=True)

    # --- the protocol -------------------------------------------------------------------------------------------------

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """A command to the page."""
        return self._call(method, parameters)

    def _send(self, method: str, parameters: dict[str, Any]) -> int:
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        return self._number

    def _call(self, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        number = self._send(method, parameters)
        until = time.monotonic() + (ANSWER_S if self._session else START_S)
        while True:
            answer = self._read(until)
            if answer.get("id") == number:
                if "error" in answer:
                    raise BrowserError(f"{method}: {answer['error']['message']}")
                return dict(answer["result"])
            self._note(answer)

    def _read(self, until: float) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            left = until - time.monotonic()
            if left <= 0 or not select.select([self._from], [], [], left)[0]:
                raise BrowserError("chromium does not answer")
            data = os.read(self._from, 1 << 16)
            if not data:
                raise BrowserError("chromium has ended")
            self._buffer += data
        text, _, self._buffer = self._buffer.partition(b"\0")
        return dict(json.loads(text))

    def _note(self, event: dict[str, Any]) -> None:
        method, about = event.get("method", ""), event.get("params", {})
        if method == "Page.javascriptDialogOpening":  # such as: leave this page? what was drawn is not saved
            self.dialogs.append(str(about["type"]))
            self._send("Page.handleJavaScriptDialog", {"accept": True})
        elif method == "Runtime.exceptionThrown":
            self.errors.append(str(about["exceptionDetails"].get("exception", {}).get("description", about)))
        elif method == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in about["args"]))
        elif method == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.errors.append(f"{about['entry']['text']} {about['entry'].get('url', '')}")
        elif method == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])

    # --- what a person does -------------------------------------------------------------------------------------------

    def look(
        self, width: int = 1280, height: int = 900, *, dark: bool = False, grey: bool = False, scale: float = 1.0
    ) -> None:
        """The size of the window, and how its owner likes pages."""
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=False
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.call("Emulation.setEmulatedVisionDeficiency", type="achromatopsia" if grey else "none")

    def open(self, url: str) -> None:
        self.call("Page.navigate", url=url)
        self.wait("document.readyState === 'complete'")

    def run(self, script: str) -> Any:
        """The value of an expression, which may be a promise."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise BrowserError(str(answer["exceptionDetails"].get("exception", {}).get("description", script)))
        return answer["result"].get("value")

    def wait(self, condition: str, seconds: float = 15.0) -> Any:
        """Until an expression is true."""
        until = time.monotonic() + seconds
        while not (value := self.run(f"Boolean({condition}) && ({condition})")):
            if time.monotonic() > until:
                raise BrowserError(f"did not come true in {seconds:g} s: {condition}")
            time.sleep(0.03)
        return value

    def key(self, name: str, *, shift: bool = False, control: bool = False) -> None:
        """A key that is pressed and let go: a letter, or a name such as Tab, Enter, ArrowLeft."""
        codes = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39}
        codes |= {"ArrowDown": 40, "Delete": 46, "Backspace": 8}
        code = codes.get(name, ord(name.upper()) if len(name) == 1 else 0)
        modifiers = (8 if shift else 0) | (2 if control else 0)
        common = {"key": name, "windowsVirtualKeyCode": code, "modifiers": modifiers}
        text = {"Enter": "\r"}.get(name, name if len(name) == 1 and not control else "")
        down = {**common, "text": text} if text else common
        self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", **down)
        self.call("Input.dispatchKeyEvent", type="keyUp", **common)

    def type(self, text: str) -> None:
        self.call("Input.insertText", text=text)

    def mouse(self, kind: str, x: float, y: float, *, clicks: int = 1) -> None:
        """kind: mousePressed, mouseReleased or mouseMoved."""
        button = "none" if kind == "mouseMoved" else "left"
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, clickCount=clicks)

    def click_at(self, x: float, y: float) -> None:
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)

    def middle_of(self, selector: str) -> tuple[float, float]:
        """Of an element, scrolled into the window."""
        box = self.run(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            " e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect();"
            " return [b.x + b.width / 2, b.y + b.height / 2]; })()"
        )
        return float(box[0]), float(box[1])

    def click(self, selector: str) -> None:
        self.click_at(*self.middle_of(selector))

    def choose(self, selector: str, file: Path) -> None:
        """Gives a file to an input that asks for one."""
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", files=[str(file)], nodeId=node)

    def keep_downloads(self, folder: Path) -> None:
        """What a page saves goes into this folder."""
        self.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))

    def picture(self, file: Path, *, whole: bool = True) -> None:
        """The window, or the whole page, as a PNG."""
        answer = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        file.write_bytes(base64.b64decode(answer["data"]))
