"""JupyterLab in a real browser, for the tests that need one."""

import os
import secrets
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress

from browser import launched
from playwright import sync_api as api


@contextmanager
def laboratory(folder):
    """JupyterLab on a free port of this machine alone: the address of its notebooks, a token."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    token = secrets.token_hex(16)
    settings = [
        "--no-browser",
        "--allow-root",
        "--ip=127.0.0.1",
        f"--port={port}",
        f"--IdentityProvider.token={token}",
        f"--ServerApp.root_dir={folder}",
        "--LabApp.news_url=",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]
    environment = os.environ | {"JUPYTER_CONFIG_DIR": str(folder / "config")}
    with subprocess.Popen(
        [sys.executable, "-m", "jupyter", "lab", *settings],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as server:
        try:
            answered(f"http://127.0.0.1:{port}/api")
            yield f"http://127.0.0.1:{port}/lab/tree/{{}}?token={token}&reset"
        finally:
            server.terminate()


def answered(address):
    for _ in range(240):
        try:
            with urllib.request.urlopen(address, timeout=1):
                return
        except OSError:
            time.sleep(0.5)
    raise TimeoutError(address)


@contextmanager
def opener(folder):
    """A function that opens a notebook of a folder by its name, in a tab of a browser."""
    with laboratory(folder) as address, api.sync_playwright() as engine:
        browser = launched(engine, "webgl")

        def opened(name):
            page = browser.new_page(viewport={"width": 1200, "height": 1000})
            page.set_default_timeout(60_000)
            page.goto(address.format(name))
            page.wait_for_selector(".jp-Notebook .jp-Cell")
            page.wait_for_selector(".jp-Notebook-ExecutionIndicator[data-status=idle]")
            return page

        yield opened
        browser.close()


def run(page, cell, holds):
    """Run a cell as a hand does, once more if the notebook was not ready for it, and wait."""
    for _ in range(4):
        page.locator(".jp-Cell .jp-InputArea-editor").nth(cell).click()
        page.keyboard.press("Shift+Enter")
        with suppress(api.TimeoutError):
            page.wait_for_function(holds, timeout=30_000)
            return
    raise TimeoutError(holds)
