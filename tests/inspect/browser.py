"""browser.py - a headless Chromium, driven by its own driver.

Room:     tests/inspect. May use: Python's standard library.
Does:     start chromedriver on a free port, open pages from files, run scripts in them,
          press keys, take pictures; say what was logged and what was asked of a network.
Does not: know what is in a page.
Source:   W3C WebDriver; the commands below /se/ and /goog/ are chromedriver's.
"""

import base64
import json
import os
import pathlib
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request

WAIT_S = 60


def is_here():
    return all(shutil.which(name) for name in ("chromium", "chromedriver"))


def _free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


class Browser:
    """A window of its own, with a profile of its own in `folder`."""

    def __init__(self, folder, width=1200, height=800, dark=True, webgl=True):
        driver, chromium = shutil.which("chromedriver"), shutil.which("chromium")
        port = _free_port()
        self.log = open(os.path.join(folder, "driver.log"), "ab")
        self.driver = subprocess.Popen([driver, f"--port={port}"], stdout=self.log,
                                       stderr=self.log)
        self.at = f"http://127.0.0.1:{port}"
        profile = os.path.join(folder, f"profile-{port}")
        options = ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox",
                   "--hide-scrollbars", f"--window-size={width},{height}",
                   "--force-color-profile=srgb", f"--user-data-dir={profile}",
                   "--disable-background-networking", "--disable-dev-shm-usage",
                   "--no-first-run"]
        if webgl:  # without a graphics card
            options += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                        "--disable-gpu-compositing"]
        else:
            options += ["--disable-gpu", "--disable-3d-apis"]
        if dark:
            options += ["--blink-settings=preferredColorScheme=0"]
        try:
            self._wait_ready()
            answer = self._ask("POST", "/session", {"capabilities": {"alwaysMatch": {
                "browserName": "chrome",
                "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
                "goog:chromeOptions": {"binary": chromium, "args": options}}}})
        except BaseException:
            self.driver.kill()
            self.driver.wait()
            raise
        self.session = f"/session/{answer['sessionId']}"

    def _wait_ready(self):
        end = time.monotonic() + WAIT_S
        while True:
            try:
                if self._ask("GET", "/status")["ready"]:
                    return
            except (urllib.error.URLError, ConnectionError):
                pass
            if time.monotonic() > end or self.driver.poll() is not None:
                raise TimeoutError("chromedriver does not answer")
            time.sleep(0.1)

    def _ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.at + path, data, method=method,
                                         headers={"Content-Type": "application/json"})
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(request, timeout=WAIT_S) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def _command(self, name, **params):
        self._ask("POST", self.session + "/goog/cdp/execute",
                  {"cmd": name, "params": params})

    def resize(self, width, height):
        """The page's room in pixels: also less than a window can have, as phones do."""
        self._command("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=1, mobile=True)

    def resize_back(self):
        self._command("Emulation.clearDeviceMetricsOverride")

    def dress(self, theme):
        """"dark" or "light"."""
        self._command("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": theme}])

    def tap(self, x, y):
        """With a finger."""
        self._command("Input.dispatchTouchEvent", type="touchStart",
                      touchPoints=[{"x": x, "y": y}])
        self._command("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def open_blank(self):
        self._ask("POST", self.session + "/url", {"url": "about:blank"})

    def open(self, path, behind=""):
        """`behind`: the address, such as "#step=3"."""
        self._ask("POST", self.session + "/url",
                  {"url": pathlib.Path(path).resolve().as_uri() + behind})

    def run(self, script, *arguments):
        """What `script`, the body of a function, returns."""
        return self._ask("POST", self.session + "/execute/sync",
                         {"script": script, "args": list(arguments)})

    def run_async(self, script, *arguments):
        """What it gives to its last argument."""
        return self._ask("POST", self.session + "/execute/async",
                         {"script": script, "args": arguments})

    def wait(self, script, *arguments):
        """Until it returns what is true."""
        end = time.monotonic() + WAIT_S
        while not (value := self.run(script, *arguments)):
            if time.monotonic() > end:
                raise TimeoutError(script)
            time.sleep(0.05)
        return value

    def frames(self, count=2):
        """Let the page draw."""
        self.run_async("""
            const [count, done] = arguments;
            const next = (left) =>
              (left > 0 ? requestAnimationFrame(() => next(left - 1)) : done());
            next(count);""", count)

    def _element(self, selector):
        found = self._ask("POST", self.session + "/element",
                          {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        self._ask("POST", f"{self.session}/element/{self._element(selector)}/click", {})

    def press(self, *keys, held=()):
        """One after the other, while others are held."""
        actions = [*({"type": "keyDown", "value": key} for key in held),
                   *({"type": kind, "value": key} for key in keys
                     for kind in ("keyDown", "keyUp")),
                   *({"type": "keyUp", "value": key} for key in held)]
        self._ask("POST", self.session + "/actions",
                  {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def picture(self, path):
        with open(path, "wb") as to:
            to.write(base64.b64decode(self._ask("GET", self.session + "/screenshot")))

    def picture_of(self, selector):
        """A PNG of an element, as base64 text."""
        return self._ask(
            "GET", f"{self.session}/element/{self._element(selector)}/screenshot")

    def said(self):
        """Warnings and errors of the console since the last time; not that a view is slow
        which no graphics card draws."""
        log = self._ask("POST", self.session + "/se/log", {"type": "browser"})
        return [line["message"] for line in log if line["level"] in ("SEVERE", "WARNING")
                and "GL Driver Message (OpenGL, Performance" not in line["message"]]

    def asked(self):
        """The addresses of all requests since the last time."""
        log = self._ask("POST", self.session + "/se/log", {"type": "performance"})
        events = [json.loads(line["message"])["message"] for line in log]
        return [event["params"]["request"]["url"] for event in events
                if event["method"] == "Network.requestWillBeSent"]

    def close(self):
        try:
            self._ask("DELETE", self.session)
        finally:
            self.driver.terminate()
            try:
                self.driver.wait(WAIT_S)
            except subprocess.TimeoutExpired:
                self.driver.kill()
                self.driver.wait()
            self.log.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
