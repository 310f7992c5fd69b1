"""A server, a browser and a page for tests of the designer."""

import pytest


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    from test_designer_page import Served

    server = Served(tmp_path_factory.mktemp("designer"))
    yield server
    server.stop()


@pytest.fixture(scope="module")
def browser():
    from test_designer_page import CHROMIUM, sync_api

    with sync_api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture
def page(browser):
    """A page; a fault in it fails the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    context.set_default_timeout(60_000)
    found = context.new_page()
    faults = []
    found.on("pageerror", lambda error: faults.append(str(error)))
    yield found
    context.close()
    assert faults == []
