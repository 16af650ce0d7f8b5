"""Who may open the page and its socket."""

import pytest

from fuzzytrack.studio.access import Access, check_token, new_token

TOKEN = "a-token-of-the-tests"
ACCESS = Access("127.0.0.1", 8098, TOKEN)
OFFERED = ["fuzzytrack", f"token.{TOKEN}"]


def headers(host="127.0.0.1:8098", origin="http://127.0.0.1:8098"):
    return {"host": host, "origin": origin}


@pytest.mark.parametrize("host", ["127.0.0.1:8098", "localhost:8098", "[::1]:8098"])
def test_a_page_of_this_server_gets_a_socket(host):
    assert ACCESS.knows({"host": host})
    assert ACCESS.admits(headers(host, f"http://{host}"), OFFERED)
    assert ACCESS.admits(headers(host, f"http://{host}"), [", ".join(OFFERED)])


@pytest.mark.parametrize(
    "host",
    ["", "evil.example:8098", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8098.evil.example",
     "localhost:8098@evil.example", "10.0.0.1:8098", "127.0.0.1:99999999"],
)  # fmt: skip
def test_another_host_is_not_known(host):
    assert not ACCESS.knows({"host": host})
    assert not ACCESS.admits(headers(host, f"http://{host}"), OFFERED)


@pytest.mark.parametrize(
    "origin",
    [None, "", "null", "http://evil.example", "https://127.0.0.1:8098", "http://127.0.0.1:8099"],
)
def test_a_page_from_elsewhere_gets_no_socket(origin):
    given = headers(origin=origin)
    if origin is None:
        del given["origin"]
    assert not ACCESS.admits(given, OFFERED)


@pytest.mark.parametrize(
    "offered",
    [[], ["fuzzytrack"], [f"token.{TOKEN}"], ["fuzzytrack", "token."],
     ["fuzzytrack", f"token.{TOKEN}x"], ["fuzzytrack", TOKEN], ["fuzzytrack", "token.ä"]],
)  # fmt: skip
def test_a_socket_needs_the_token(offered):
    assert not ACCESS.admits(headers(), offered)


def test_a_server_for_all_addresses_is_known_by_any_number():
    anywhere = Access("0.0.0.0", 80, TOKEN)
    assert anywhere.knows({"host": "192.168.1.7"})
    assert anywhere.knows({"host": "localhost:80"})
    assert not anywhere.knows({"host": "evil.example"})


def test_tokens_are_long_and_differ():
    assert check_token(new_token()) != new_token()
    for short in ("", "x" * 15, "with a blank in the middle", "ümlaut-ümlaut-ümlaut"):
        with pytest.raises(ValueError, match="token: needs 16 or more letters"):
            check_token(short)
