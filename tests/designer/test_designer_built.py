"""The types of messages are built from the records; what else is built, `make lint` compares."""

from tools.message_types import FILE, printed_types


def test_the_types_of_messages_are_those_of_the_records(update_golden):
    if update_golden:
        FILE.write_text(printed_types(), encoding="utf-8")
    assert FILE.read_text(encoding="utf-8") == printed_types(), "make types"
