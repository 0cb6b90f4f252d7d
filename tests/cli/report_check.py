#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Laws of a report of pzs, read as a page: report_check.py FILE.html|FILE.svg LAW [ARGUMENT...]

  xml            every SVG of the file is well-formed XML with a title and a description, and holds no NaN or infinity; no
                 tag of the page is cut in two
  text WORD...   the page's text holds each word, after its markup is read
  ring NAME      the elements of the patch of the amplifier NAME cover the area between two circles, its voltage is inside
  over           voltages in a picture are written over the patches, never under them
  apart COUNT    COUNT voltages are written in a picture, and no two of them overlap
  value NAME     the patch of the amplifier NAME has its value written, and the mark of an active limit
  inside         the lines of the target and of curves lie inside their pictures
  uniform        neighbouring colours of each scale are equally far apart in the OKLab space, within a factor of 1.6
  contrast       the text colours stand out from their backgrounds by 4.5 at least, in light and in dark
"""
import html
import math
import re
import sys
import xml.etree.ElementTree as tree

SVG = '{http://www.w3.org/2000/svg}'


def svgs(page):
    """Outermost SVG elements of a page, as text."""
    depth, start = 0, 0
    for tag in re.finditer(r'<(/?)svg\b[^>]*>', page):
        if not tag.group(1):
            start = tag.start() if depth == 0 else start
            depth += 1
        else:
            depth -= 1
            if depth == 0:
                yield page[start:tag.end()]
    assert depth == 0, 'an svg element is not closed'


def numbers_of(element):
    """Numbers in the attributes that place an element."""
    for name in ('d', 'x', 'y', 'cx', 'cy', 'r', 'width', 'height', 'viewBox', 'transform'):
        text = element.get(name, '')
        assert not re.search(r'nan|inf', text, re.I), f'{name}="{text[:60]}"'
        if name == 'd':
            assert not re.search(r'[A-Za-z]{2}', text.replace('zM', 'z M')), text[:60]


def law_xml(page):
    pictures = list(svgs(page))
    assert pictures, 'no picture'
    for text in pictures:
        root = tree.fromstring(text)
        names = [child.tag.replace(SVG, '') for child in root]
        assert names[:2] == ['title', 'desc'], names[:2]
        for element in root.iter():
            numbers_of(element)
    words = re.sub(r'<style>.*?</style>|<[^>]*>', ' ', page, flags=re.S)
    assert '>' not in words, 'half a tag in the text: ' + words[max(0, words.find('>') - 40):words.find('>') + 20]
    assert not re.search(r'(?<![a-z])-?(nan|inf)(?![a-z])', words.lower().replace('nan,', '')), 'nan or inf in the text'


def law_text(page, *words):
    text = html.unescape(re.sub(r'<[^>]*>', '', page)).replace('\xa0', ' ')
    for word in words:
        assert word in text, f'{word!r} is missing'


def patches(page, name):
    """Groups of an amplifier's patch, one in each picture of voltages."""
    found = []
    for text in svgs(page):
        for group in tree.fromstring(text).iter():
            title = group[0] if len(group) and group.tag.endswith('g') else None
            if title is not None and title.tag.endswith('title') and title.text.startswith(name + ':'):
                found.append(group)
    assert found, f'no patch of {name}'
    return found


def written(page, name):
    """The texts in which an amplifier's voltage is written: (text, class, middle x and y, half width, half height)."""
    found = []
    for text in svgs(page):
        for e in tree.fromstring(text).iter():
            if e.tag.endswith('text') and len(e) and e[0].text.startswith(name + ':'):
                size = float(e.get('style').split(':')[1].rstrip('px'))
                middle = float(e.get('x')), float(e.get('y')) - .36 * size
                found.append((e.text, e.get('class'), *middle, .3 * size * len(e.text), .36 * size))
    return found


def area(side):
    points = [tuple(map(float, p.split())) for p in re.split('[ML]', side.strip('z')) if p]
    return sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(points, points[1:] + points[:1])) / 2


def law_ring(page, name):
    group = patches(page, name)[0]
    path = [e.get('d') for e in group.iter() if e.tag.endswith('path')][0]
    parts = [side for side in path.split('z') if side]
    points = [tuple(map(float, p.split())) for part in parts for p in re.split('[ML]', part) if p]
    middle = [(max(c) + min(c)) / 2 for c in zip(*points)]
    radii = [math.dist(p, middle) for p in points]
    outer, inner = ({p: r for p, r in zip(points, radii) if abs(r - end) < .3} for end in (max(radii), min(radii)))
    covered = sum(abs(area(part)) for part in parts)
    squares = [(sum(circle.values()) / len(circle)) ** 2 for circle in (outer, inner)]
    ring = (squares[0] - squares[1]) * len(outer) / 2 * math.sin(2 * math.pi / len(outer))
    rounding = .05 * 2 / (max(radii) - min(radii)) / len(outer) ** .5  # of coordinates with one decimal, in the mean
    assert min(radii) > 1 and abs(covered / ring - 1) < rounding, (covered, ring, rounding)
    for text, style, x, y, across, up in written(page, name):
        if 'tag' in style:  # a voltage at a limit is written where it has no room, too
            continue
        corners = [math.dist((x + i * across, y + j * up), middle) for i in (-1, 1) for j in (-1, 1)]
        assert min(radii) < min(corners) and max(corners) < max(radii), f'{text} is not inside its ring: {corners}, {radii}'


def law_over(page):
    """No voltage lies under a patch: in each picture of voltages the texts follow the last patch."""
    texts = 0
    for picture in svgs(page):
        elements = list(tree.fromstring(picture).iter())
        value = [i for i, e in enumerate(elements) if e.tag.endswith('text') and len(e) and e[0].tag.endswith('title')]
        patch = [i for i, e in enumerate(elements) if len(e) and e.tag.removeprefix(SVG) == 'g' and e[0].tag.endswith('title')]
        assert not value or max(patch) < min(value), 'a voltage may lie under a patch'
        texts += len(value)
    assert texts > 0, 'no voltage is written'


def law_value(page, name):
    limited = [g for g in patches(page, name) if 'limit active' in g[0].text]
    assert limited, 'no patch says that its limit is active'
    group = limited[0]
    said = group[0].text
    shown = [text[0] for text in written(page, name)]
    assert any(e.get('class', '').startswith('limit') for e in group.iter()), 'no mark of the limit'
    value = said.split(':')[1].split('\xa0')[0].strip()
    assert any(abs(float(text.replace('−', '-')) - float(value.replace('−', '-'))) <= 0.5 for text in shown), (shown, value)


def law_apart(page, count):
    """The voltages of one picture lie apart: no two texts overlap."""
    pictures = [[e for e in tree.fromstring(p).iter() if e.tag.endswith('text') and len(e) and e[0].tag.endswith('title')] for p in svgs(page)]
    texts = max(pictures, key=len)
    assert len(texts) == int(count), len(texts)
    box = [(float(e.get('x')), float(e.get('y')), float(e.get('style').split(':')[1].rstrip('px')), len(e.text)) for e in texts]
    for k, one in enumerate(box):
        for other in box[:k]:
            size = (one[2] + other[2]) / 2
            apart = abs(one[0] - other[0]) > .3 * (one[2] * one[3] + other[2] * other[3]) or abs(one[1] - other[1]) > .7 * size
            assert apart, f'two voltages overlap: {one}, {other}'


def law_inside(page):
    lines = 0
    for picture in svgs(page):
        for element in tree.fromstring(picture).iter():
            if 'viewBox' in element.keys():
                right, bottom = map(float, element.get('viewBox').split()[2:])
            if 'wire' in element.get('class', '').split():
                for x, y in re.findall(r'[ML](\S+?) ([^MLz]+)', element.get('d', '')):
                    assert 0 <= float(x) <= right and 0 <= float(y) <= bottom, (x, y, right, bottom)
                    lines += 1
    assert lines > 0, 'no line of a target or a curve'


def linear(channel):
    return channel / 12.92 if channel <= .04045 else ((channel + .055) / 1.055) ** 2.4


def channels(colour):
    colour = colour.lstrip('#')
    if len(colour) == 3:
        colour = ''.join(2 * c for c in colour)
    return [linear(int(colour[i:i + 2], 16) / 255) for i in (0, 2, 4)]


def oklab(colour):
    r, g, b = channels(colour)
    cones = [.4122214708 * r + .5363325363 * g + .0514459929 * b, .2119034982 * r + .6806995451 * g + .1073969566 * b,
             .0883024619 * r + .2817188376 * g + .6299787005 * b]
    l, m, s = [c ** (1 / 3) for c in cones]
    return (.2104542553 * l + .793617785 * m - .0040720468 * s, 1.9779984951 * l - 2.428592205 * m + .4505937099 * s,
            .0259040371 * l + .7827717662 * m - .808675766 * s)


def law_uniform(page):
    for scale in ('v', 's'):
        levels = re.findall(r'\.%s(\d+)\{fill:(#[0-9a-f]{6})' % scale, page)
        for theme in range(len(levels) // 33):
            colours = [oklab(c) for _, c in levels[33 * theme:33 * theme + 33]]
            steps = [math.dist(a, b) for a, b in zip(colours, colours[1:])]
            middle = sorted(steps)[16]
            assert max(steps) < 1.6 * middle and min(steps) > middle / 1.6, (scale, theme, min(steps), middle, max(steps))
            light = [c[0] for c in colours]
            halves = [light] if scale == 'v' else [light[:17], light[16:]]
            for half in halves:
                assert half == sorted(half) or half == sorted(half, reverse=True), (scale, theme, 'lightness')


def law_contrast(page):
    themes = re.findall(r':root\{(--page:[^}]*)\}', page)
    assert len(themes) == 2
    for theme in themes:
        colour = dict(re.findall(r'--(\w+):(#\w+)', theme))
        shine = {k: sum(w * c for w, c in zip((.2126, .7152, .0722), channels(v))) for k, v in colour.items()}
        for text in ('ink', 'soft', 'force', 'wire'):
            for back in ('page', 'panel'):
                high, low = sorted((shine[text], shine[back]), reverse=True)
                assert (high + .05) / (low + .05) >= 4.5, (text, back)


def main():
    path, law, *arguments = sys.argv[1:]
    page = open(path, encoding='utf-8').read()
    {'xml': law_xml, 'text': law_text, 'ring': law_ring, 'over': law_over, 'apart': law_apart, 'value': law_value, 'inside': law_inside, 'uniform': law_uniform,
     'contrast': law_contrast}[law](page, *arguments)


main()
