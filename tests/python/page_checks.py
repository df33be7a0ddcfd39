# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""What every page of ours has to keep, asked of a browser: contrast, names, width, no fetching, no complaints."""

from __future__ import annotations

from typing import Any

from elmopp_tools.browser import Browser

LEAST_CONTRAST = 4.5

# Each text that is to be seen, with its contrast to what lies behind it (WCAG 2.1, 1.4.3). What lies behind SVG text is
# the nearest filled shape below it in the same drawing.
CONTRASTS = """
(() => {
  const parse = (text) => { const n = text.match(/[\\d.]+/g).map(Number); return n.length < 4 ? [...n, 1] : n; };
  const linear = (c) => { c /= 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
  const light = (c) => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
  const ratio = (a, b) => { const [x, y] = [light(a), light(b)].sort((p, q) => q - p);
    return (x + 0.05) / (y + 0.05); };
  const behind = (node) => {
    for (let e = node; e; e = e.parentElement) {
      const colour = parse(getComputedStyle(e).backgroundColor);
      if (colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  const under = (node) => {
    const box = node.getBoundingClientRect(), x = box.x + box.width / 2, y = box.y + box.height / 2;
    for (const e of document.elementsFromPoint(x, y)) {
      if (e === node || e.tagName === 'text' || e.tagName === 'line') continue;
      if (e instanceof SVGGeometryElement) {
        const fill = getComputedStyle(e).fill;
        if (fill !== 'none') return parse(fill);
      } else if (e instanceof HTMLElement || e.tagName === 'svg') return behind(e);
    }
    return behind(node);
  };
  const found = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const node = walk.currentNode.parentElement, text = walk.currentNode.textContent.trim();
    if (!text || ['SCRIPT', 'STYLE', 'OPTION', 'OPTGROUP'].includes(node.tagName)) continue;
    if (!node.getClientRects().length) continue;
    const style = getComputedStyle(node);
    if (style.visibility === 'hidden' || node.closest('[data-no-contrast]')) continue;
    node.scrollIntoView({ block: 'center' });
    const svg = node instanceof SVGElement;
    found.push([ratio(parse(svg ? style.fill : style.color), svg ? under(node) : behind(node)), text]);
  }
  scrollTo(0, 0);
  return found;
})()
"""

# Everything that a key can reach, in the order of the Tab key, with what a screen reader would call it.
REACHABLE = """
[...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex="0"]')]
  .filter((e) => e.getClientRects().length && !e.disabled)
  .map((e) => [e.id || e.className, (e.getAttribute('aria-label') ||
    (e.labels && e.labels.length && e.labels[0].textContent)
    || (e.getAttribute('aria-labelledby') && document.getElementById(e.getAttribute('aria-labelledby')).textContent)
    || e.textContent || '').trim()])
"""


def contrasts(browser: Browser) -> list[tuple[float, str]]:
    found: list[tuple[float, str]] = [(float(ratio), str(text)) for ratio, text in browser.run(CONTRASTS)]
    assert found
    return found


def expect_contrast(browser: Browser) -> None:
    bad = [(round(ratio, 2), text) for ratio, text in contrasts(browser) if ratio < LEAST_CONTRAST]
    assert not bad, bad


def expect_names(browser: Browser) -> list[str]:
    """Every control has a name; returns their ids in order."""
    reachable: list[list[Any]] = browser.run(REACHABLE)
    assert reachable
    assert not [name for name, label in reachable if not label]
    return [str(name) for name, _ in reachable]


def expect_fits(browser: Browser) -> None:
    """Nobody has to scroll sideways."""
    wide, window = browser.run("[document.documentElement.scrollWidth, innerWidth]")
    assert wide <= window


def expect_quiet(browser: Browser, *hosts: str) -> None:
    """No complaint, and nothing asked of anybody but these."""
    assert browser.errors == []
    foreign = [url for url in browser.requests if not url.startswith(("data:", "blob:", *hosts))]
    assert foreign == []
