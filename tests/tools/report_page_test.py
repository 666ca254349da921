#!/usr/bin/env python3
"""Checks a report's markup, then opens it in headless Chromium and uses it as a person would.
Usage: report_page_test.py PAGE [PICTURE_FOLDER]

Exit status 0: all holds; 1: an assertion failed; 77: there is no Chromium here (Debian's package is chromium).
"""
import json
import os
import re
import sys
from html.parser import HTMLParser

sys.dont_write_bytecode = True  # nothing beside the sources
from chromium import Page, find_chromium

HOSTILE = "</script><img src=x onerror=1>"


def data_of(file):
    text = open(file, encoding="utf-8").read()
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.S).group(1))


class Markup(HTMLParser):
    """Every element is closed in its order and every id stands once."""
    VOID = {"meta", "link", "input", "br", "img", "hr"}

    def __init__(self, text):
        super().__init__()
        self.open, self.ids = [], set()
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        if tag not in self.VOID:
            self.open.append(tag)
        for name, value in attrs:
            assert name != "id" or value not in self.ids, f"id {value} stands twice"
            if name == "id":
                self.ids.add(value)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, f"</{tag}> out of place at {self.getpos()}"


def is_miss(instance):
    return instance["counts"] and not instance["hit"]


def misses_of(data):
    return [(f, i) for f in data["frames"] for i in f["instances"] if is_miss(i)]


def alarms_of(data):
    return [(f, d) for f in data["frames"] for d in f["detections"] if d["verdict"] == "false"]


def shown(page, kind):
    return page.evaluate(f"[...document.querySelectorAll('.card.{kind}')].filter(c => c.getClientRects().length).length")


def choose(page, field, value):
    page.evaluate(f"(() => {{ const s = document.getElementById('filter-{field}'); s.value = {json.dumps(value)};"
                  "s.dispatchEvent(new Event('change')); })()")


def check_content(page, data):
    assert page.evaluate("document.getElementById('title').textContent") == data["dataset"]
    assert shown(page, "miss") == len(misses_of(data)) > 0
    assert shown(page, "alarm") == len(alarms_of(data)) > 0
    assert page.evaluate("document.querySelectorAll('.chart').length") >= 4
    assert page.evaluate("document.images.length") == 0, "a name became markup"
    assert HOSTILE in page.evaluate("document.getElementById('objects').textContent")


def check_filters(page, data):
    for object_id in data["objects"]:
        choose(page, "object", object_id)
        assert shown(page, "miss") == sum(i["object"] == int(object_id) for _, i in misses_of(data))
        assert shown(page, "alarm") == sum(d["object"] == int(object_id) for _, d in alarms_of(data))
    choose(page, "object", "")
    causes = {i["cause"] for _, i in misses_of(data)} | {d["cause"] for _, d in alarms_of(data)}
    for cause in causes:
        choose(page, "cause", cause)
        assert shown(page, "miss") == sum(i["cause"] == cause for _, i in misses_of(data)), cause
        assert shown(page, "alarm") == sum(d["cause"] == cause for _, d in alarms_of(data)), cause
    page.click("#filters button[type=reset]")
    page.wait_for("document.getElementById('filter-cause').value === ''")
    assert shown(page, "miss") == len(misses_of(data))
    first = misses_of(data)[0][1]["cause"]
    page.click(f"#causes button[data-cause='{first}']")
    assert shown(page, "miss") == sum(i["cause"] == first for _, i in misses_of(data))
    page.click(f"#causes button[data-cause='{first}']")
    assert shown(page, "miss") == len(misses_of(data)), "a second click takes the filter away"


def check_keys(page, data):
    active = "document.activeElement.id"
    ids = page.evaluate("[...document.querySelectorAll('.card.miss')].map(c => c.id)")
    page.press("n")
    assert page.evaluate(active) == ids[0]
    page.press("n")
    assert page.evaluate(active) == ids[1]
    page.press("p")
    assert page.evaluate(active) == ids[0]
    page.press("Enter", 13)
    assert page.evaluate("document.getElementById('viewer').open")
    page.wait_for("document.querySelector('#viewer-picture image') !== null")
    first = page.evaluate("document.getElementById('viewer-title').textContent")
    page.press("ArrowRight", 39)
    assert page.evaluate("document.getElementById('viewer-title').textContent") != first
    page.wait_for("document.querySelector('#viewer-picture .truth') !== null")
    display = "getComputedStyle(document.querySelector('#viewer-picture .truth')).display"
    before = page.evaluate(display)
    page.press("4")
    assert before != "none" == page.evaluate(display), "key 4 switches the truth"
    page.press("4")
    image = "document.querySelector('#viewer-picture image').getAttribute('href')"
    page.wait_for("document.querySelector('#viewer-picture image') !== null")
    left = page.evaluate(image)
    page.press("r")
    page.wait_for("document.querySelector('#viewer-picture image') !== null")
    assert page.evaluate(image) != left, "key R shows the right image"
    page.press("Escape", 27)
    page.wait_for(f"{active} === '{ids[1]}'")  # the card last looked at has the focus again
    assert not page.evaluate("document.getElementById('viewer').open")


def check_table(page):
    column = "[...document.querySelectorAll('#instance-table tbody tr')].map(r => parseFloat(r.children[2].textContent))"
    page.click("#instance-table thead th:nth-child(3) button")
    values = page.evaluate(column)
    assert values == sorted(values)
    page.click("#instance-table thead th:nth-child(3) button")
    assert page.evaluate(column) == sorted(values, reverse=True)


def check_appearance(page):
    colour = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(colour)
    page.press("t")
    assert page.evaluate(colour) != light
    page.press("t")
    assert page.evaluate(colour) == light
    for width in (1400, 800, 360):
        page.resize(width, 800)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), f"wider than {width} px"


def main():
    file = os.path.abspath(sys.argv[1])
    data = data_of(file)
    text = open(file, encoding="utf-8").read()
    assert text.lower().startswith("<!doctype html>")
    assert {"data", "misses", "alarms", "frames", "viewer"} <= Markup(text).ids
    program = find_chromium()
    if program is None:
        print("skipped: no Chromium is installed; apt-get install chromium to run this")
        return 77
    with Page(program) as page:
        page.load("file://" + file)
        check_content(page, data)
        check_filters(page, data)
        check_keys(page, data)
        check_table(page)
        check_appearance(page)
        if len(sys.argv) > 2:
            page.resize(1400, 900)
            page.screenshot(os.path.join(sys.argv[2], "report.png"), whole=True)
        outside = [r for r in page.requests if not r.startswith(("file://" + file, "blob:", "data:"))]
        assert not outside, f"the page asked for {outside}"
        assert not page.problems, page.problems
    return 0


if __name__ == "__main__":
    sys.exit(main())
