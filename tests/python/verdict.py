"""Expectations of a session: each prints a line when it holds and ends the session when it does not."""


class Failure(Exception):
    """The drive did something else than its manual or the standard says."""


def ok(what):
    """Reports what was found to be right."""
    print(f"OK   {what}", flush=True)


def expect(condition, what, otherwise=""):
    """Reports `what`, or raises it as a failure with what was seen instead."""
    if not condition:
        raise Failure(f"{what}{': ' if otherwise else ''}{otherwise}")
    ok(what)


def expect_equal(seen, wanted, what):
    """As `expect`, for values."""
    expect(seen == wanted, f"{what} = {shown(wanted)}", f"got {shown(seen)}")


def shown(value):
    """A value as an engineer writes it: counts in decimal, all else that is a number in hexadecimal."""
    return f"{value:#x}" if isinstance(value, int) and value > 9 else repr(value)
