#!/usr/bin/env python3
"""The pages of `foldline report` and `foldline sweep report` in headless Chromium: no console error, the figures hold the data of the log,
the slider moves the shell, tasks are chosen, and they fit a phone. Usage: report.py FOLDLINE CHROMIUM (needs the package `playwright`, but none of its browsers)."""

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


SWEEP = """
title = "small"
scene = "baseline-quarter"
settings = ["load.rotation_deg=2"]
outputs = ["last.moment_n_mm", "theory_stiffness_n_mm"]
[[axis]]
key = "geometry.radius_mm"
values = [9, 10, 11, 12]
[[axis]]
key = "material.thickness_mm"
values = [0.1, 0.12]
"""


def sweep(folder, browser):
    """The page of a sweep: every task drawn and listed, links that lead to logs, and a choice along an axis."""
    (folder / "s.toml").write_text(SWEEP)
    run("sweep", "run", folder / "s.toml", "--folder", folder / "s")
    run("sweep", "report", folder / "s")
    for width, scheme in [(1200, "light"), (360, "dark")]:
        page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
        said = []
        page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url) if request.url.startswith("http") else None)
        page.goto((folder / "s" / "report.html").as_uri())
        page.wait_for_function("find('listed').textContent !== ''")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        curves = page.evaluate("charts[0].data.datasets.map((set) => set.data.length)")
        assert curves == [4, 4], curves
        assert page.evaluate("charts[1].data.datasets[0].data.length") == 8
        for link in page.evaluate("[...document.querySelectorAll('#tasks a')].map((a) => a.getAttribute('href'))"):
            assert (folder / "s" / link).is_file(), link
        box = page.locator("#parallel").bounding_box()
        page.locator("#parallel").scroll_into_view_if_needed()
        box = page.locator("#parallel").bounding_box()
        first, bottom = box["x"] + box["width"] / 8, box["y"] + box["height"] - 22
        page.mouse.move(first, bottom + 5)
        page.mouse.down()
        page.mouse.move(first, bottom - 0.5 * (box["height"] - 68))
        page.mouse.up()
        assert page.evaluate("find('listed').textContent").startswith("4 of 4 chosen of 8"), page.evaluate("find('listed').textContent")
        assert not said, said
        print(f"{width} pixels, {scheme}: the page of a sweep draws, lists and chooses its tasks")
        page.close()


def shown(page, canvas):
    return page.evaluate(f"document.getElementById('{canvas}').toDataURL()")


def structure(folder, browser):
    """The page of a structure: both shells are drawn, what is not glued is grey, and elements are counted for each."""
    log, html = folder / "boom.mcap", folder / "boom.html"
    run("run", "-q", Path(__file__).parents[2] / "pipelines/structures/trac-boom.toml", "--until", "0.2", "-o", log)
    run("report", log, "-o", html)
    page = browser.new_page(viewport={"width": 1200, "height": 800})
    said = []
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(html.as_uri())
    page.wait_for_function("find('at').textContent !== ''")
    assert page.evaluate("find('at').textContent").endswith("30 × 9 + 30 × 9 elements"), page.evaluate("find('at').textContent")
    assert page.evaluate("charts[1].data.datasets[0].data.at(-1).y") == 540
    counts = page.evaluate("current.shape.counts")
    assert len(counts) == 2 and page.evaluate("quads(current.shape).length") == sum((a - 1) * (b - 1) for a, b in counts), counts
    points = page.evaluate("places(current.shape, current.shape.frames[0].points).length / 3")
    assert points == sum(a * b for a, b in counts) == page.evaluate("Math.max(...quads(current.shape).flat()) + 1")
    pairs = page.evaluate("pairs(current.shape, current.shape.frames[0]).length / 6")
    assert pairs == sum(l * (b - 1) + m * (a - 1) for (a, b), (l, m) in zip(counts, page.evaluate("current.shape.frames[0].line_counts")))
    peel = page.evaluate("current.shape.fields.findIndex((field) => field.title.startsWith('bond peel'))")
    pictures = [page.locator("#stage").screenshot()]
    page.select_option("#field", str(peel))
    pictures.append(page.locator("#stage").screenshot())
    assert pictures[0] != pictures[1]
    # The webs are glued, and the flanges are not.
    colours = page.evaluate(f"[...coloured(current.shape, current.shape.frames.at(-1), {peel})]")
    grey = sum(colours[i:i + 3] == [0.75] * 3 for i in range(0, len(colours), 3)) * 3 / len(colours)
    assert 0.4 < grey < 0.9, grey
    assert not said, said
    print(f"a structure: {len(counts)} shells, {points:.0f} points, {100 * grey:.0f} % of them not glued")
    page.close()


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
    structure(folder, browser)
    sweep(folder, browser)
    browser.close()
