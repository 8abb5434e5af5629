#!/usr/bin/env python3
"""The page of `foldline report` in headless Chromium: no console error, the figures hold the data of the log, the slider moves the
shell, and it fits a phone. Usage: report.py FOLDLINE CHROMIUM (needs the package `playwright`, but none of its browsers)."""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

foldline, chromium = sys.argv[1:3]
ARGUMENTS = ["--no-sandbox", "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def run(*arguments):
    subprocess.run([foldline, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def settled(log):
    """The last equilibrium of every load step, from the log."""
    text = subprocess.run([foldline, "inspect", str(log), "--json"], check=True, capture_output=True, text=True).stdout
    found = {}
    for stage in map(json.loads, text.splitlines()):
        if stage["outcome"] == "done" and stage["stage"] in ("solve", "re-equilibrate"):
            found[stage["step"]] = stage
    return found


def shown(page, canvas):
    return page.evaluate(f"document.getElementById('{canvas}').toDataURL()")


with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
    folder = Path(folder)
    log, html = folder / "baseline.mcap", folder / "baseline.html"
    run("run", "-q", Path(__file__).parents[2] / "pipelines/baseline-quarter.toml", "--until", "20", "-o", log)
    run("report", log, "-o", html)
    size = html.stat().st_size
    assert size < 10_000_000, size
    browser = driver.chromium.launch(executable_path=chromium, args=ARGUMENTS)
    for width, scheme in [(1200, "light"), (360, "dark")]:
        page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
        said = []
        page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url) if request.url.startswith("http") else None)
        began = time.monotonic()
        page.goto(html.as_uri())
        page.wait_for_function("find('at').textContent !== ''")
        opened = time.monotonic() - began
        assert not said, said
        wide = page.evaluate("[...document.querySelectorAll('body *')].filter((e) => e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.tagName + '#' + e.id)")
        assert page.evaluate("document.documentElement.scrollWidth") <= width, f"wider than the screen: {wide}"
        rest, *drawn = page.evaluate("charts[0].data.datasets[0].data.map((p) => [p.x, p.y])")
        assert rest == [0, 0], rest
        stages = list(settled(log).values())
        assert len(drawn) == len(stages), (len(drawn), len(stages))
        for (x, y), stage in zip(drawn, stages):
            assert x == stage["rotation_deg"] and y == stage["moment_n_mm"], (x, y, stage)
        last = page.evaluate("find('at').textContent")
        pictures = []
        for step in (0, 5):
            page.evaluate(f"find('step').value = {step}; find('step').dispatchEvent(new Event('input'))")
            pictures.append(page.locator("#stage").screenshot())
        assert pictures[0] != pictures[1] and page.evaluate("find('at').textContent") != last
        page.select_option("#field", "1")
        assert "displacement" in page.evaluate("find('means').textContent")
        assert not said, said
        print(f"{width} pixels, {scheme}: {size / 1e6:.1f} MB, open after {opened:.2f} s, {len(drawn)} load steps as in the log")
        page.close()
    browser.close()
