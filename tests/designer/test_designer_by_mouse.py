"""A rule base by mouse: variables, terms, methods, grids and rules are edits of the text."""

import re

import pytest
from needs import requires
from test_designer_page import becomes, put, text_of, until

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.inference import infer
from fuzzyarm.language import parse

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]


@pytest.fixture
def open_page(context, served):
    faults = []

    def opened(name, text):
        address = put(served, name, text)[1]
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(address)
        until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
        return page

    yield opened
    assert faults == []


def fill(page, **answers):
    """Fill in a dialog and send it; it closes."""
    for name, answer in answers.items():
        field = page.locator(f"dialog [name={name}]")
        if field.evaluate("field => field.tagName") == "SELECT":
            field.select_option(answer)
        else:
            field.fill(answer)
    page.locator("dialog .row button[type=submit]").click()
    until(lambda: page.locator("dialog").count() == 0, "the dialog closes")


def add(page, role, **answers):
    page.get_by_role("button", name=f"{role} …", exact=True).click()
    fill(page, **answers)


def test_from_a_heading_to_a_rule_base_and_all_the_way_back(open_page):
    blank = 'rulebase mine "by mouse"\n'
    page = open_page("mine.frb", blank)
    page.get_by_text("There is no variable yet").wait_for()
    page.get_by_role("button", name="Output …", exact=True).click()
    page.locator("dialog [name=variable]").fill("u")
    page.locator("dialog [name=low]").fill("1")
    page.locator("dialog .row button[type=submit]").click()
    page.get_by_text("from a lower to a higher number").wait_for()  # and can be put right
    fill(page, low="-1", terms="N 'almost zero' P")
    add(page, "Input", variable="e", low="-2", high="2", terms="N Z P")
    add(page, "Input", variable="the rate", low="-5", high="5", terms="N P")
    until(lambda: page.locator(".terms .head").count() == 3, "their plots")
    page.get_by_role("button", name="Grid …").click()
    fill(page, row="e", column="the rate", fill="empty")
    page.get_by_text("There are no rules yet.").wait_for()
    page.get_by_role("button", name="Undo").click()
    until(lambda: not page.locator(".rules td select").count(), "no grid")
    page.get_by_role("button", name="Grid …").click()
    fill(page, row="e", column="the rate", fill="rising")
    until(lambda: page.locator(".rules td select").count() == 6, "its cells")
    until(lambda: not page.evaluate("designer.store.scene.missing.length"), "a surface")
    model = parse(text_of(page)).rulebase
    value = infer(model, {"e": 1.5, "the rate": 2.0})["u"]
    until(
        lambda: page.evaluate("designer.store.running.at([1.5, 2])[0]") == pytest.approx(value),
        "what the page computes",
    )

    # A setting, a rule of lists, a row of a new term, a column that goes.
    page.locator(".methods summary").click()
    page.get_by_label("and", exact=True).select_option("product")
    until(lambda: "inference and product\n" in text_of(page), "the setting")
    assert page.locator(".methods[open]").count() == 1
    page.locator(".composer select[data-variable=e]").select_option("Z")
    page.locator(".composer select[data-variable=u]").select_option("almost zero")
    page.locator(".composer button").click()
    until(lambda: "rule if e is Z then u is 'almost zero'\n" in text_of(page), "the rule")
    page.get_by_role("button", name="Row …").click()
    fill(page, name="PB", peak="1.8")
    until(lambda: "term e PB: triangle " in text_of(page), "the new term")
    labels = [line.split()[0] for line in text_of(page).splitlines() if line.startswith("  ")]
    assert labels == ["e", "N", "Z", "PB", "P"]
    until(lambda: page.locator(".rules td select").count() == 8, "its cells, drawn")
    page.locator(".rules th button", has_text="N").first.click()
    page.get_by_role("button", name="Remove the column N").click()
    until(lambda: re.search(r"e \\ 'the rate' +P\n", text_of(page)), "the column has gone")
    page.get_by_role(
        "button", name="e: Give it another name, wherever it stands: Rename …", exact=True
    ).click()
    fill(page, name="error")
    until(lambda: "input  error" in text_of(page), "its other name")
    page.get_by_role("button", name="the rate: Remove it").click()
    fill(page)
    until(lambda: "the rate" not in text_of(page), "removed")
    assert "rules u" not in text_of(page)  # the grid has gone with it
    page.get_by_role("button", name="Undo").click()
    until(lambda: "rules u" in text_of(page), "one step back")
    undo = page.get_by_role("button", name="Undo")
    for _ in range(30):
        if undo.is_enabled():
            undo.click()
    assert not undo.is_enabled()
    assert text_of(page) == blank
    page.get_by_text("There is no variable yet").wait_for()


@pytest.mark.parametrize("order", [("Input", "Output"), ("Output", "Input")])
def test_variables_may_come_in_any_order(open_page, order):
    page = open_page("order.frb", 'rulebase order "o"\n')
    for role in order:
        add(page, role, variable=role[0].lower(), terms="A B")
    page.locator(".composer select[data-variable=i]").select_option("A")
    page.locator(".composer button").click()
    until(lambda: page.evaluate("designer.store.surface()?.z.length > 0"), "a surface")
    for name in ("i", "o"):
        page.get_by_role("button", name=f"{name}: Remove it").click()
        fill(page)
    page.get_by_text("There is no variable yet").wait_for()


def test_each_edit_is_one_step(open_page):
    text = shipped("pd7.frb").read_text()
    page = open_page("steps.frb", text)
    undo = page.get_by_role("button", name="Undo")

    def done(what, act):
        act()
        until(lambda: text_of(page) != text, what)
        undo.click()
        until(lambda: text_of(page) == text, f"{what} undone")
        until(lambda: not page.evaluate("designer.store.stale"), "drawn")

    def remove_grid():
        page.get_by_role("button", name="Remove the grid of u").click()

    def add_row():
        page.get_by_role("button", name="Row …").click()
        fill(page, name="near", peak="0.4")

    def set_method():
        page.locator(".methods").evaluate("details => details.open = true")
        page.get_by_label("defuzzifier").select_option("bisector")

    def remove_variable():
        page.get_by_role("button", name="ce: Remove it").click()
        fill(page)

    done("the grid", remove_grid)
    done("a row with its term", add_row)
    done("a method", set_method)
    done("a variable", remove_variable)


def test_what_is_refused_is_said_where_it_was_asked_for(open_page):
    page = open_page("refused.frb", shipped("pd7.frb").read_text())
    add_input = page.get_by_role("button", name="Input …", exact=True)
    add_input.click()
    page.locator("dialog [name=variable]").fill("e")
    page.keyboard.press("Enter")
    page.locator("dialog .error").get_by_text("there is a variable 'e' already").wait_for()
    page.locator("dialog [name=low]").fill("zero")
    page.keyboard.press("Enter")
    page.locator("dialog .error").get_by_text("'zero' .. '1' is not a range").wait_for()
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Column …").click()
    page.locator("dialog [name=name]").fill("ZE")
    page.keyboard.press("Enter")
    page.locator("dialog .error").get_by_text("has 'ZE' already").wait_for()
    page.keyboard.press("Escape")
    page.locator(".composer button").click()
    page.locator(".composer .wrong").get_by_text("if … then …").wait_for()
    rule = page.get_by_label("A new rule", exact=True)
    rule.fill("if e is HOT then u is ZE")
    rule.press("Enter")
    page.locator(".sentence .wrong").get_by_text("HOT").wait_for()
    rule.fill("")
    becomes(page.locator(".sentence .wrong").count, 0)

    # A number that is not taken stays with the reason beside it, and the point where it was.
    point = page.evaluate("[...designer.store.point]")
    value, wrong = page.get_by_label("e: value", exact=True), page.locator(".slider .wrong")
    for typed, words, at in (
        ("7", "7 is outside -6 .. 6, and counts as 6", [6, point[1]]),  # as `eval` answers
        ("0,5", "'0,5' is not a number", [6, point[1]]),
        ("1.2", "", point),
        ("", "'' is not a number", point),
    ):
        value.fill(typed)
        value.press("Tab")
        assert (value.input_value(), wrong.all_inner_texts()) == (typed, [words] if words else [])
        assert page.evaluate("[...designer.store.point]") == pytest.approx(at)
    page.get_by_role("slider", name="e", exact=True).press("ArrowRight")  # moves the point
    until(lambda: wrong.count() == 0 and float(value.input_value()) == pytest.approx(1.23), "moved")
    assert text_of(page) == shipped("pd7.frb").read_text()


def test_lists_of_rules_stay_where_they_are_scrolled_and_the_last_rule_goes(open_page):
    text = shipped("tipper.frb").read_text()
    page = open_page("last.frb", text)
    for _ in range(3):
        count = page.locator(".rules li").count()
        page.locator(".rules li").first.get_by_text("×").click()
        until(lambda count=count: page.locator(".rules li").count() == count - 1, "removed")
    page.get_by_text("There are no rules yet").wait_for()
    assert page.locator(".terms .head").count() == 3  # what is there stays drawn
    page.locator(".composer select[data-variable=food]").select_option("RANCID")
    page.locator(".composer button").click()
    until(lambda: page.locator(".rules li").count() == 1, "a rule again")
