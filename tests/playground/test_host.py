"""What answers in a page, run without one."""

import asyncio
import base64
import json

import pytest

from fuzzyarm.apps.designer import threads
from fuzzyarm.apps.designer.jobs import Downloads
from fuzzyarm.apps.playground import host
from fuzzyarm.apps.playground.host import LARGEST_TEXT, USED, begin, warm
from fuzzyarm.base.shipped_files import shipped

TIPPER = shipped("tipper.frb").read_text(encoding="utf-8")


class Page:
    """Says things to a host, and waits for what it says."""

    def __init__(self, folder, files):
        self.said, self.downloads = [], Downloads()
        self.folder = folder / "files"
        self.hear, self.store = begin(files, self.take, self.downloads, self.folder)

    def take(self, text):
        self.said.append(json.loads(text))

    async def tell(self, wanted, **message):
        """Say something, and return the first answer that is wanted."""
        known = len(self.said)
        self.hear(json.dumps(message))
        return await self.heard(wanted, known)

    async def heard(self, wanted, known):
        """Return the first answer that is wanted after those that are known."""
        for _ in range(2000):
            for each in self.said[known:]:
                if wanted(each):
                    return each
            await asyncio.sleep(0.01)
        raise AssertionError(self.said[known:])


def kind(name):
    return lambda message: message["is"] == name


async def test_a_text_is_checked_while_it_is_typed(tmp_path):
    page = Page(tmp_path, {"tipper.frb": TIPPER})
    opened = await page.tell(kind("opened"), do="open", file="tipper.frb")
    assert opened["text"] == TIPPER
    updates = [{"clientID": "x", "changes": [[0, "nonsense", ""], len(TIPPER)]}]
    found = await page.tell(
        lambda m: m["is"] == "findings" and m["version"] == 1,
        do="push", file="tipper.frb", version=opened["version"], updates=updates,
    )  # fmt: skip
    assert "error" in found["summary"]


async def test_a_new_file_is_to_be_stored_and_what_another_tab_stores_is_taken(tmp_path):
    page = Page(tmp_path, {"tipper.frb": TIPPER})
    await page.tell(kind("opened"), do="open", file="tipper.frb")
    renamed = {"do": "folder", "what": "rename", "file": "tipper.frb", "name": "waiter.frb"}
    await page.tell(kind("moved"), id=1, **renamed)
    kinds = [each["is"] for each in page.said]
    assert kinds.index("stored") < kinds.index("moved")  # the page then forgets the old name
    assert page.said[kinds.index("stored")]["text"] == TIPPER

    # The tab that had it open and wrote it takes what the other one makes of it.
    updates = [{"clientID": "x", "changes": [[0, "# mine", ""], len(TIPPER)]}]
    await page.tell(kind("updates"), do="push", file="waiter.frb", version=0, updates=updates)
    known = len(page.said)
    page.store("waiter.frb", f"# theirs\n{TIPPER}")
    status = await page.heard(lambda message: "saved" in message, known)
    assert (status["conflict"], status["dirty"]) == (False, False)
    page.store("new.frb", TIPPER)
    await page.heard(lambda m: m["is"] == "names" and "new.frb" in m["names"], known)
    page.store("waiter.frb", None)
    assert (await page.heard(kind("moved"), known))["to"] == ""
    assert [path.name for path in page.folder.iterdir()] == ["new.frb"]


async def test_what_is_exported_is_given_to_the_page(tmp_path):
    page = Page(tmp_path, {"tipper.frb": TIPPER})
    await page.tell(kind("opened"), do="open", file="tipper.frb")
    news = await page.tell(
        lambda m: m.get("files"), do="start", file="tipper.frb", id=1, what="export", suffix=".h"
    )
    key = news["files"][0]["href"].split("/")[1]
    name, content = page.downloads.find(key)
    assert (name, b"tipper" in content) == ("tipper.h", True)


async def test_where_webassembly_cannot_wait_news_come_before_the_end(tmp_path, monkeypatch):
    monkeypatch.setattr(threads, "IN_A_PAGE", True)
    monkeypatch.setattr(threads, "can_take_turns", lambda: False)
    monkeypatch.setattr(host, "can_take_turns", lambda: False)
    page = Page(tmp_path, {"tipper.frb": TIPPER})
    await page.tell(kind("opened"), do="open", file="tipper.frb")
    export = {"do": "start", "file": "tipper.frb", "id": 1, "what": "export", "suffix": ".h"}
    ended = await page.tell(lambda m: m.get("end"), **export)
    assert ended["end"] == "done"
    news = [each for each in page.said if each["is"] == "job"]
    assert news[-1] is ended
    assert any(each.get("files") for each in news)
    refused = await page.tell(lambda m: m.get("id") == 2, **{**export, "id": 2, "what": "run"})
    assert "needs a browser that lets WebAssembly wait" in refused["message"]


async def test_a_file_of_another_program_is_converted(tmp_path):
    page = Page(tmp_path, {})
    fis = b"[System]\nName='x'\nType='mamdani'\n[Input1]\nnonsense"
    answer = await page.tell(
        lambda m: m.get("id") == 1, do="folder", id=1, what="import", name="x.fis",
        data=base64.b64encode(fis).decode(),
    )  # fmt: skip
    assert answer["error"]
    picture = base64.b64encode(b"\x89PNG\x00\xff\xfe" * 40).decode()
    answer = await page.tell(
        lambda m: m.get("id") == 2, do="folder", id=2, what="import", name="a.frb", data=picture
    )
    assert "UTF-8" in answer["error"] or "text" in answer["error"]


async def test_a_huge_text_is_not_checked_and_says_so(tmp_path):
    page = Page(tmp_path, {"huge.frb": "# x\n" * (LARGEST_TEXT // 4 + 1)})
    failed = await page.tell(kind("failed"), do="open", file="huge.frb")
    assert "this page checks at most 500,000" in failed["message"]
    assert "nothing of it is lost" in failed["message"]


async def test_names_that_no_file_can_have_are_left_out(tmp_path):
    page = Page(tmp_path, {"../a.frb": "", "a/b.frb": "", "b.frb": TIPPER, "half.frb": "\ud800"})
    answer = await page.tell(lambda m: m.get("id") == 1, do="folder", id=1, what="list")
    assert [each["name"] for each in answer["files"]] == ["b.frb"]
    assert sorted(path.name for path in tmp_path.rglob("*.frb")) == ["b.frb"]


@pytest.mark.slow
async def test_the_motor_runs(tmp_path):
    names = ("servo.frb", "pd7.frb")
    page = Page(tmp_path, {name: shipped(name).read_text(encoding="utf-8") for name in names})
    await page.tell(kind("opened"), do="open", file="servo.frb")
    news = await page.tell(
        lambda m: m.get("news") == "reached", do="start", file="servo.frb", id=3, what="run",
        form={"plant": "motor"}, until="0.2s", speed=None,
    )  # fmt: skip
    assert news["id"] == 3
    await page.tell(lambda m: m.get("end") == "stopped", do="stop", id=3)


def test_what_a_page_will_want_is_there():
    warm()
    assert len(set(USED)) == len(USED)
