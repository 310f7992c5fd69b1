"""The pictures of the designer's panes: all words are legible, and all curves are there.

The page is asked what it draws, not how its pixels look: each text on a canvas is recorded with the
box around it, each stroke with its colour. So no picture is kept, and any browser will do.
"""

import pytest
from needs import requires
from test_designer_page import Served, further, put, until

from fuzzyarm import load
from fuzzyarm.base.shipped_files import shipped

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]

# Records by canvas, since it was cleared: texts as [words, left, top, right, bottom] in
# pixels of the canvas, and the colours of strokes.
RECORD = """(() => {
  const own = CanvasRenderingContext2D.prototype, drawn = window.drawn = new Map();
  const of = ({ canvas }) => {
    if (!drawn.has(canvas)) drawn.set(canvas, { texts: [], strokes: [] });
    return drawn.get(canvas);
  };
  const instead = (name, does) => {
    const original = own[name];
    own[name] = function (...words) { does(this, words); return original.apply(this, words); };
  };
  instead("clearRect", (g) => drawn.delete(g.canvas));
  instead("stroke", (g) => of(g).strokes.push(String(g.strokeStyle)));
  instead("fillText", (g, [words, x, y, most = Infinity]) => {
    const size = g.measureText(words), { a, b, c, d, e, f } = g.getTransform();
    const squeeze = Math.min(1, most / size.width);
    const [before, behind] = [size.actualBoundingBoxLeft, size.actualBoundingBoxRight];
    const xs = [x - squeeze * before, x + squeeze * behind];
    const ys = [y - size.actualBoundingBoxAscent, y + size.actualBoundingBoxDescent];
    const corners = xs.flatMap((u) => ys.map((v) => [a * u + c * v + e, b * u + d * v + f]));
    const ends = [0, 1].map((k) => corners.map((corner) => corner[k]));
    const [left, top] = ends.map((each) => Math.min(...each));
    const [right, bottom] = ends.map((each) => Math.max(...each));
    of(g).texts.push([words, left, top, right, bottom]);
  });
})()"""

# The words of each picture that is shown, by its pane, with the size of the picture.
WORDS = """() => {
  const ratio = Math.min(2, devicePixelRatio), found = [];
  const paneOf = (e) => e.closest(".pane, section")?.className.replace("pane ", "");
  for (const [canvas, { texts, strokes }] of drawn) {
    if (!canvas.isConnected || !canvas.offsetParent) continue;
    const scaled = texts.map(([words, ...box]) => [words, ...box.map((x) => x / ratio)]);
    const size = [canvas.clientWidth, canvas.clientHeight];
    found.push({ pane: paneOf(canvas), size, texts: scaled, strokes });
  }
  for (const picture of document.querySelectorAll(".pane svg")) {
    const frame = picture.getBoundingClientRect();
    const seen = [...picture.querySelectorAll("text")].map((e) => [e, e.getBoundingClientRect()]);
    const texts = seen.filter(([, box]) => box.width).map(([e, box]) => [
      e.textContent, box.left - frame.left, box.top - frame.top,
      box.right - frame.left, box.bottom - frame.top,
    ]);
    const lines = [...picture.querySelectorAll("path, polyline, line")];
    found.push({ pane: paneOf(picture), size: [frame.width, frame.height], texts,
                 strokes: lines.map((e) => getComputedStyle(e).stroke) });
  }
  return found;
}"""

CONTOUR = """() => {
  [["contour", 0], ["y", 1]].forEach(([to, i]) => {
    const select = [...document.querySelectorAll(".surface .bar select")].slice(-2)[i];
    select.value = to;
    select.dispatchEvent(new Event("change"));
  });
}"""
CHOSEN = "() => document.querySelector('.plots text[data-term]').focus()"
AS_WRITTEN = """() => {
  const select = document.querySelector(".inference select");
  select.value = "text";
  select.dispatchEvent(new Event("change"));
}"""

ROUNDING = 1.0  # pixels that a letter may touch the edge or its neighbour


def cut(picture):
    """Return the words that are not wholly inside their picture."""
    width, height = picture["size"]
    return [
        words
        for words, left, top, right, bottom in picture["texts"]
        if min(left, top) < -ROUNDING or right > width + ROUNDING or bottom > height + ROUNDING
    ]


def overlapping(picture):
    """Return the pairs of words of a picture that lie on each other."""
    texts = picture["texts"]
    return [
        (one[0], other[0])
        for k, one in enumerate(texts)
        for other in texts[:k]
        if one[0] != other[0]
        and min(one[3], other[3]) - max(one[1], other[1]) > ROUNDING
        and min(one[4], other[4]) - max(one[2], other[2]) > ROUNDING
    ]


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    server = Served(tmp_path_factory.mktemp("pictures"))
    yield server
    server.stop()


def at_rest(page, panes):
    """Return what panes draw once all of them have, and draw nothing else any more."""
    seen = [[]]

    def rests():
        seen.append(page.evaluate(WORDS))
        page.wait_for_timeout(300)  # panes are drawn a frame later, one after the other
        drawn = {picture["pane"] for picture in seen[-1]}
        return panes <= drawn and seen[-1] == seen[-2]

    until(rests, panes)
    return seen[-1]


def pictures_of(served, browser, name, scheme, script="", ratio=1):
    """Return what the panes of a shipped rule base draw."""
    address = put(served, f"{name}.frb", shipped(f"{name}.frb").read_text())[1]
    context = browser.new_context(
        viewport={"width": 1280, "height": 720}, color_scheme=scheme, device_scale_factor=ratio
    )
    page = context.new_page()
    page.add_init_script(RECORD)
    page.goto(address)
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    if script:
        page.evaluate(script)
    found = at_rest(page, {"terms", "surface", "inference"})
    context.close()
    return found


@pytest.mark.parametrize(
    ("name", "scheme", "script", "ratio"),
    [
        ("pd7", "light", "", 1),
        ("pd7", "dark", AS_WRITTEN, 2),
        ("tipper2", "light", CHOSEN, 1),
        ("thermostat", "dark", CONTOUR, 2),
    ],
)
def test_words_of_pictures_are_neither_cut_nor_on_each_other(
    name, scheme, script, ratio, served, browser
):
    found = pictures_of(served, browser, name, scheme, script, ratio)
    assert [(p["pane"], words) for p in found for words in cut(p)] == []
    assert [(p["pane"], pair) for p in found for pair in overlapping(p)] == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_each_term_has_its_name_and_a_curve_in_its_colour(scheme, served, browser):
    rulebase = load(shipped("tipper2.frb"))
    found = [p for p in pictures_of(served, browser, "tipper2", scheme) if p["pane"] == "terms"]
    words = [[text[0] for text in picture["texts"]] for picture in found]
    for variable in (*rulebase.inputs, *rulebase.outputs):
        names = [term.name for term in variable.terms]
        of_variable = [p for p, said in zip(found, words, strict=True) if set(names) <= set(said)]
        assert of_variable, variable.name
        assert len(set(of_variable[0]["strokes"])) >= len(names)


@pytest.mark.parametrize(("name", "view"), [("servo", "Run"), ("pd7", "Table")])
def test_views_with_pictures_cut_no_words(name, view, served, browser):
    address = put(served, f"{name}.frb", shipped(f"{name}.frb").read_text())[1]
    put(served, "pd7.frb")
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.add_init_script(RECORD)
    page.goto(address)
    page.get_by_text("no findings").first.wait_for()
    further(page, view)
    until(lambda: [p for p in page.evaluate(WORDS) if p["texts"]], f"a picture of {view}")
    found = at_rest(page, set())
    context.close()
    assert [(p["pane"], words) for p in found for words in cut(p)] == []
    assert [(p["pane"], pair) for p in found for pair in overlapping(p)] == []


def test_words_beyond_a_picture_and_on_each_other_are_seen():
    picture = {"size": [100, 50], "texts": [["a", 90, 5, 104, 15], ["b", 80, 10, 92, 20]]}
    assert cut(picture) == ["a"]
    assert overlapping(picture) == [("b", "a")]
