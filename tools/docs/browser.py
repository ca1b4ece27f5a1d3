#!/usr/bin/env python3
"""browser.py FOLDER [CHROMIUM]: opens every page below FOLDER in headless Chromium, from the file and without network.

Faults: a request for anything that is not a file below FOLDER, a file that is not there, an error or a warning of the console, an
exception of a script; text that runs past the edge of a window 1200 or 420 units wide or is cut within an element; a formula or a
program that has to be scrolled to be read. Of the folder rust the first pages alone are opened, and their programs may be
scrolled: rustdoc writes them all alike.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote, urlsplit

WIDTHS = [1200, 420]
RUST_PAGES = 5
# Text whose element hides what does not fit, where no bar scrolls to it; formulas and programs (pre) that have a bar; the page where
# it is wider than the window.
CUT = """(() => {
  const found = [];
  const page = document.documentElement;
  if (page.scrollWidth > page.clientWidth + 1) found.push(`the page is ${page.scrollWidth} wide, the window ${page.clientWidth}`);
  for (const e of document.querySelectorAll('pre, code, p, td, th, h1, h2, h3, li')) {
    const way = getComputedStyle(e).overflowX;
    if ((way === 'hidden' || way === 'clip') && e.clientWidth > 1 && e.scrollWidth > e.clientWidth + 1)
      found.push(`cut: ${e.textContent.trim().slice(0, 60)}`);
    else if (WHOLE && e.closest('pre') && e.clientWidth > 1 && e.scrollWidth > e.clientWidth + 1)
      found.push(`has to be scrolled to be read: ${e.textContent.trim().slice(0, 60)}`);
  }
  return found;
})()"""


class Browser:
    """Chromium that is told what to do through a pipe: file descriptors 3 and 4, messages in JSON that end with a zero byte."""

    def __init__(self, program, profile):
        to_browser, self.out = os.pipe()
        self.into, from_browser = os.pipe()
        command = [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--no-first-run",
                   "--disable-background-networking", "--disable-dev-shm-usage", "--host-resolver-rules=MAP * ~NOTFOUND",
                   f"--user-data-dir={profile}"]

        def descriptors():
            # Both may be 3 or 4 already: out of the way first.
            read, write = os.dup(to_browser), os.dup(from_browser)
            read, write = os.dup(read), os.dup(write)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.process = subprocess.Popen(command, preexec_fn=descriptors, close_fds=False, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.rest, self.events, self.session = 0, b"", [], None

    def message(self):
        while b"\0" not in self.rest:
            more = os.read(self.into, 1 << 16)
            if not more:
                sys.exit("browser.py: Chromium has ended")
            self.rest += more
        text, _, self.rest = self.rest.partition(b"\0")
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        call = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            call["sessionId"] = self.session
        os.write(self.out, json.dumps(call).encode() + b"\0")
        while (message := self.message()).get("id") != self.number:
            self.events.append(message)
        if "error" in message:
            sys.exit(f"browser.py: {method}: {message['error']}")
        return message["result"]

    def until(self, method):
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.message())

    def begin(self):
        page = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def open(self, page, width, whole):
        """What the browser says while it loads the page, and what it shows cut."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.events.clear()
        self.call("Page.navigate", url=page.as_uri())
        self.until("Page.loadEventFired")
        cut = self.call("Runtime.evaluate", expression=CUT.replace("WHOLE", str(whole).lower()), returnByValue=True)["result"].get("value", [])
        return list(self.events), cut

    def end(self):
        self.process.terminate()
        self.process.wait()


def faults(events, folder):
    for event in events:
        what, values = event.get("method"), event.get("params", {})
        if what == "Network.requestWillBeSent":
            url = values["request"]["url"]
            parts = urlsplit(url)
            if parts.scheme not in ("file", "data", "blob", "about"):
                yield f"request to {url}"
            elif parts.scheme == "file" and not Path(unquote(parts.path)).resolve().is_relative_to(folder):
                yield f"file outside: {url}"
        elif what == "Network.loadingFailed" and not values.get("canceled"):
            yield f"not loaded: {values.get('errorText')}"
        elif what == "Runtime.exceptionThrown":
            yield f"exception: {values['exceptionDetails'].get('exception', {}).get('description', '')[:200]}"
        elif what == "Runtime.consoleAPICalled" and values["type"] in ("error", "warning", "assert"):
            yield f"console: {[argument.get('value') for argument in values['args']]}"
        elif what == "Log.entryAdded" and values["entry"]["level"] in ("error", "warning"):
            yield f"console: {values['entry']['text']} {values['entry'].get('url', '')}"


def is_rust(page, folder):
    return page.relative_to(folder).parts[0] == "rust"


def pages(folder):
    found = sorted(folder.rglob("*.html"))
    rust = [page for page in found if is_rust(page, folder)]
    return [page for page in found if page not in rust] + [page for page in rust if "src" not in page.parts][:RUST_PAGES]


def check(folder, program):
    """The faults of all pages below the folder, a line each, and the number of pages."""
    folder = folder.resolve()
    listed, lines = pages(folder), []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            browser.begin()
            for page in listed:
                for width in WIDTHS:
                    events, cut = browser.open(page, width, whole=not is_rust(page, folder))
                    lines += [f"{page.relative_to(folder)}, {width} wide: {fault}" for fault in [*faults(events, folder), *cut]]
        finally:
            browser.end()
    return list(dict.fromkeys(lines)), len(listed)


def main(folder, program=None):
    program = program or shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not program:
        sys.exit("browser.py: no Chromium")
    lines, number = check(Path(folder), program)
    print("\n".join(lines + [f"{number} pages in Chromium, {len(lines)} faults"]))
    return 1 if lines or not number else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
