"""The view Run in a browser: it starts, moves, is pushed, tuned by slider and stopped."""

import math
import re
from pathlib import Path

import pytest
from crane import SLEDGE
from needs import requires
from test_designer_accessibility import AXE, violations
from test_designer_page import Served, becomes, box_of, put, text_of, until

from fuzzyarm.base.shipped_files import shipped

pytestmark = [
    requires("chromium"),
    pytest.mark.slow,
]


def open_run(served, browser, name, text="", **options):
    """Open a text, or a shipped file, in the view Run; its faults are kept."""
    address = put(served, f"{name}.frb", text or shipped(f"{name}.frb").read_text())[1]
    context = browser.new_context(**options)
    page = context.new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.on("console", lambda said: said.type == "error" and page.faults.append(said.text))
    page.goto(address)
    page.get_by_role("tab", name="Run").click()
    until(lambda: page.locator(".run-form select").nth(1).input_value(), "the plants")
    return page


def clock(page):
    found = re.match(r"[\d.]+", page.locator("output.clock").text_content())
    return float(found[0]) if found else 0.0


def metric(page, name):
    row = page.locator(".metrics tr", has=page.get_by_role("rowheader", name=name, exact=True))
    number = re.match(r"[-\d.e]+", row.locator("td").text_content())
    return float(number[0]) if number else math.nan  # it is not known yet


def final_error(page):
    return metric(page, "final")


def is_still(page):
    """Whether the clock stands; what was under way when it was stopped may still come."""
    before = clock(page)
    page.wait_for_timeout(200)
    return clock(page) == before


def test_the_motor_runs_is_pushed_and_tuned_and_stops(served, browser):
    page = open_run(served, browser, "servo")
    before = text_of(page)
    assert page.locator(".run-form select").nth(1).input_value() == "motor"
    assert (
        page.locator(".run").get_by_label("Reference", exact=True).input_value()
        == "position=step:1"
    )
    page.locator(".run").get_by_role("button", name="Start").click()
    until(lambda: clock(page) > 0.6, "it moves")
    until(lambda: abs(final_error(page)) < 1e-3, "it arrives")
    page.get_by_text(
        "2 s, the time asked for"
    ).wait_for()  # the time of the plant; all of it is in view
    becomes(lambda: clock(page), 2)
    drawn = page.locator(".run-picture canvas").evaluate("canvas => canvas.toDataURL()")

    # Pushed by the mouse and by the keyboard: it gives way while it is held, and comes back.
    canvas = page.locator(".run-picture canvas")
    box = box_of(canvas)
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 40, steps=3)
    until(lambda: abs(final_error(page)) > 1.0, "it gives way")
    until(lambda: canvas.evaluate("canvas => canvas.toDataURL()") != drawn, "it is drawn")
    page.mouse.up()
    until(lambda: abs(final_error(page)) < 1e-2, "it comes back")
    canvas.focus()
    page.keyboard.down("ArrowUp")
    until(lambda: abs(final_error(page)) > 1.0, "it gives way to the key")
    page.keyboard.up("ArrowUp")
    until(lambda: abs(final_error(page)) < 1e-2, "it comes back")

    # Space pauses, a step is a sample.
    page.keyboard.press("Space")
    page.locator(".run").get_by_role("button", name="Go on").wait_for()
    at = clock(page)
    page.locator(".run").get_by_role("button", name="Step").click()
    until(lambda: clock(page) == pytest.approx(at + 0.001), "a step")
    page.locator(".run").get_by_role("button", name="Go on").click()

    # A slider is an edit of the text, which is taken up and can be undone.
    page.get_by_label("G_u", exact=True).focus()
    page.keyboard.press("ArrowRight")
    until(lambda: text_of(page) != before, "the gain is an edit")
    number = re.search(r'gain G_u  = ([\d.]+) "V", tune 1 \.\. 10 log', text_of(page))
    assert 4.5 < float(number[1]) < 4.6
    page.get_by_text("The text of now runs.").wait_for()
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+z")
    assert text_of(page) == before
    until(
        lambda: page.get_by_label("G_u: value").input_value() == "4.5",
        "the slider follows the text",
    )
    page.evaluate("designer.text.goTo([6, 7])")
    page.keyboard.press("Delete")
    page.keyboard.type("2")  # period 2 ms
    page.get_by_text("Restart runs it").wait_for()
    page.locator(".run").get_by_role("button", name="Restart").click()
    until(lambda: clock(page) < at, "it begins again")
    page.locator(".run").get_by_role("button", name="Stop").click()
    page.locator(".run").get_by_role("button", name="Start").wait_for()
    until(lambda: is_still(page), "the clock stops")
    assert page.faults == []
    page.context.close()


def test_what_is_changed_at_the_end_is_run_from_the_start(served, browser):
    page = open_run(served, browser, "servo")
    page.locator(".run").get_by_label("Speed").select_option("")  # as fast as possible
    page.locator(".run").get_by_role("button", name="Start").click()
    page.get_by_text("2 s, the time asked for").wait_for()
    rms = page.locator(".metrics tr.first td").first
    until(rms.inner_text, "the metrics of the first")
    before = rms.inner_text()
    page.locator(".run").get_by_role("button", name="Start").wait_for()
    gain = page.get_by_label("G_u: value")
    gain.fill("2")
    gain.press("Enter")
    until(lambda: rms.inner_text() not in {"", before}, "another response")
    page.get_by_text("2 s, the time asked for").wait_for()
    page.locator(".run").get_by_label("open end").check()
    page.locator(".run").get_by_role("button", name="Restart").click()
    until(lambda: clock(page) > 3, "it goes on")
    assert page.faults == []
    page.context.close()


def test_rules_that_are_not_saved_are_said_where_they_run(served, browser):
    put(served, "used.frb", shipped("pd7.frb").read_text())
    text = shipped("servo.frb").read_text().replace("pd7.frb", "used.frb")
    address = put(served, "using.frb", text)[1]
    context = browser.new_context()
    page = context.new_page()
    page.goto(f"{served.address}#file=used.frb")
    until(lambda: page.evaluate("!!window.designer?.store.scene"), "a picture")
    page.evaluate("designer.text.goTo([0, 0])")
    page.keyboard.type("# more\n")
    until(lambda: page.evaluate("designer.text.settled()"), "sent")
    page.goto(address)
    page.get_by_role("tab", name="Run").click()
    page.get_by_text("used.frb has unsaved changes; the run uses the saved version.").wait_for()
    page.get_by_role("button", name="Save used.frb").click()
    until(lambda: (served.folder / "used.frb").read_text().startswith("# more\n"), "saved")
    context.close()


def test_a_rule_base_alone_says_what_to_do_and_a_click_does_it(served, browser):
    put(served, "servo.frb", shipped("servo.frb").read_text())
    address = put(served, "tipper.frb", shipped("tipper.frb").read_text())[1]
    context = browser.new_context()
    page = context.new_page()
    page.goto(address)
    page.get_by_role("tab", name="Run").click()
    page.get_by_text("tipper.frb is a rule base, not a controller").wait_for()
    assert page.locator(".around").get_by_role("button", name="servo.frb").is_visible()
    assert page.locator(".run").get_by_role("button", name="Start").is_disabled()
    page.get_by_role("button", name="Make a controller").click()
    page.get_by_role("dialog").get_by_role("button", name="Create").click()
    until(lambda: page.title().startswith("tipper-controller.frb"), "it is shown")
    until(lambda: 'use tipper from "tipper.frb"' in text_of(page), "around the rule base")
    until(lambda: page.locator(".run-form select").nth(1).input_value() == "motor", "the plant")
    assert page.locator(".run").get_by_label("Duration", exact=True).input_value() == "2s"
    context.close()


def test_a_rule_base_runs_on_the_arm_and_a_dragged_corner_counts(served, browser):
    page = open_run(served, browser, "pd7", bypass_csp=AXE.exists(), color_scheme="dark")
    page.locator(".run").get_by_label("Speed").select_option("0.2")
    page.locator(".run").get_by_role("button", name="Start").click()
    until(lambda: clock(page) > 0.2, "it moves")
    page.locator(".run").get_by_role("button", name="Pause").click()  # before its end
    page.locator(".run").get_by_role("button", name="Go on").wait_for()
    assert page.get_by_label("G_e", exact=True).is_enabled()
    page.get_by_role("tab", name="Design").click()
    page.get_by_label("u PM: corner 2").focus()
    page.keyboard.press("ArrowRight")
    page.get_by_role("tab", name="Run").click()
    page.get_by_text("The text of now runs.").wait_for()
    if AXE.exists():
        page.evaluate(AXE.read_text())
        assert violations(page) == []
    assert page.faults == []
    page.context.close()


# --- The examples of delays, rates and modes, by the mouse ---

EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"


def start_example(page, name):
    page.locator(".run").get_by_role("button", name="Start").click()
    until(lambda: clock(page) > 0, f"{name} runs")


def slide(page, gain, share):
    """Click a slider at a share of its length, scrolled into view."""
    slider = page.get_by_label(gain, exact=True)
    box = box_of(slider)
    slider.click(position={"x": share * box["width"], "y": box["height"] / 2})


def test_the_cascade_of_three_rates_is_clicked_pushed_and_holds(served, browser):
    text = (EXAMPLES / "cascade-servo.frb").read_text("utf-8")
    page = open_run(served, browser, "cascade-servo", text)
    page.get_by_role("tab", name="Design").click()
    page.locator(".diagram .block.gain", has_text="K_s").click()
    row = text.splitlines().index("  amps = e * K_s + load")
    head = "designer.text.view.state.doc.lineAt(designer.text.view.state.selection.main.head)"
    assert page.evaluate(f"{head}.number") == row + 1
    page.get_by_role("tab", name="Run").click()
    page.locator(".run").get_by_label("open end").check()  # or its time may end in the transient
    start_example(page, "the cascade")
    until(lambda: abs(final_error(page)) < 1e-3, "it arrives")
    box = box_of(page.locator(".run-picture canvas"))
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 40, steps=3)
    # The integral takes the push up within 0.2 s; the overshoot keeps that the shaft gave way.
    until(lambda: metric(page, "overshoot") > 0.01, "it gives way")
    page.mouse.up()
    until(lambda: abs(final_error(page)) < 1e-3, "it comes back")
    assert page.faults == []
    page.context.close()


def test_the_heater_is_taken_by_hand_and_given_back(served, browser):
    text = (EXAMPLES / "manual-heater.frb").read_text("utf-8")
    page = open_run(served, browser, "manual-heater", text)
    page.locator(".run").get_by_label("open end").check()
    start_example(page, "the heater")
    until(lambda: abs(final_error(page)) < 0.3, "it is warm")
    slide(page, "auto", 0.02)
    until(lambda: re.search(r"gain auto  = 0", text_of(page)), "by hand")
    page.get_by_text("The text of now runs.").wait_for()
    slide(page, "raise", 0.98)
    until(lambda: "gain raise = 1 " in text_of(page), "the hand raises the power")
    until(lambda: final_error(page) < -4.0, "the hand heats")
    slide(page, "auto", 0.98)
    until(lambda: abs(final_error(page)) < 0.3, "and the controller cools again")
    slide(page, "raise", 0.5)  # the range is that of the start: the hand can hold
    until(lambda: "gain raise = 0 " in text_of(page), "the hand is at rest")
    assert page.faults == []
    page.context.close()


def test_the_predictor_meets_a_dead_time_that_is_typed_in(served, browser):
    text = (EXAMPLES / "smith-heater.frb").read_text("utf-8")
    page = open_run(served, browser, "smith-heater", text)
    run = page.locator(".run")
    run.get_by_text("Sensors, actuators and disturbances").click()
    run.get_by_label("Delay of actuators", exact=True).fill("power=10min")
    run.get_by_label("Duration", exact=True).fill("2h")
    start_example(page, "the predictor")
    page.get_by_text("the time asked for").wait_for()
    assert abs(final_error(page)) < 0.1
    assert metric(page, "overshoot") < 0.05
    assert page.faults == []
    page.context.close()


PULL = """controller pull
period 5 ms
axis cart
  e = error of x
  drive force = 2 * e, within -30 .. 30
"""


def test_a_plant_of_the_command_line_counts_for_the_findings(tmp_path, browser):
    (tmp_path / "own.py").write_text(SLEDGE)
    (tmp_path / "files").mkdir()
    server = Served(tmp_path / "files", options=["--plant", f"{tmp_path / 'own.py'}:Sledge"])
    try:
        page = open_run(server, browser, "pull", PULL)
        page.get_by_text("no findings").wait_for()
        assert page.faults == []
        page.context.close()
    finally:
        server.stop()
