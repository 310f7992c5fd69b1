"""A server, a browser and a page for tests of the designer."""

import functools
import logging

import pytest

from fuzzyarm.base.shipped_files import shipped

TOKEN = "a" * 32


class Faults(logging.Handler):
    """Keeps what is said of faults of the program."""

    def __init__(self):
        super().__init__(logging.ERROR)
        self.records = []

    def emit(self, record):
        self.records.append(record)


@pytest.fixture(autouse=True)
def faults(request):
    """Fail a test that meets a fault of the program, if it is not marked to have one."""
    log, handler = logging.getLogger("fuzzyarm.apps.designer"), Faults()
    log.addHandler(handler)
    yield handler.records
    log.removeHandler(handler)
    if request.node.get_closest_marker("faults") is None:
        assert [logging.Formatter().format(each) for each in handler.records] == []


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    from test_designer_page import Served

    server = Served(tmp_path_factory.mktemp("designer"))
    yield server
    server.stop()


def patient_context(new_context, **options):
    """Open a context that waits as long as `until` does: a busy machine takes its time."""
    found = new_context(**{"viewport": {"width": 1280, "height": 720}, **options})
    found.set_default_timeout(60_000)
    return found


@pytest.fixture(scope="module")
def browser():
    from test_designer_page import CHROMIUM, sync_api

    with sync_api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        found.new_context = functools.partial(patient_context, found.new_context)
        yield found
        found.close()


@pytest.fixture(scope="module")
def shared_context(browser):
    """What the pages of a module are opened in: it has the modules of a page compiled."""
    found = browser.new_context()
    yield found
    found.close()


@pytest.fixture
def context(shared_context):
    """The same with no page in it; none is left, and nothing of what one has stored."""
    yield shared_context
    for page in shared_context.pages:
        if page.url.startswith("http"):
            page.evaluate("localStorage.clear()")
        page.close()


@pytest.fixture
def page(context):
    """A page; a fault in it fails the test."""
    found = context.new_page()
    faults = []
    found.on("pageerror", lambda error: faults.append(str(error)))
    yield found
    assert faults == []


@pytest.fixture
def client(tmp_path):
    from starlette.testclient import TestClient

    from fuzzyarm.apps.designer.server import Designer, Workspace

    text = shipped("pd7.frb").read_text()
    (tmp_path / "inside").mkdir()
    (tmp_path / "inside" / "pd7.frb").write_text(text)
    (tmp_path / "outside.frb").write_text(text)
    (tmp_path / "inside" / "link.frb").symlink_to(tmp_path / "outside.frb")
    app = Designer(Workspace(tmp_path / "inside"), TOKEN).app()
    with TestClient(app, base_url="http://127.0.0.1:8000") as found:
        yield found
