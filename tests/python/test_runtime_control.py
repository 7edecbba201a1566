"""Settings of running nodes, against a master and a service that are played here."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Iterator
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from pytpc.base.errors import RunError
from pytpc.ros.node_status import chosen, values_of
from pytpc.ros.ros1.connection import encode_header
from pytpc.ros.ros1.instrumented_nodes import InstrumentedNodes

HOST = "127.0.0.1"


class Handler(SimpleXMLRPCRequestHandler):
    rpc_paths = ()


class Master:
    """Knows services by their addresses, and parameters."""

    def __init__(self) -> None:
        self.services: dict[str, str] = {}
        self.params: dict[str, object] = {}
        self.server = SimpleXMLRPCServer((HOST, 0), Handler, logRequests=False)
        self.server.register_instance(self)
        self.uri = f"http://{HOST}:{self.server.server_address[1]}/"
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.01,))
        self.thread.start()

    def _dispatch(self, method: str, arguments: tuple) -> list:
        if method == "getSystemState":
            return [1, "", [[], [], [[name, ["/x"]] for name in self.services]]]
        if method == "lookupService":
            uri = self.services.get(arguments[1])
            return [1, "", uri] if uri else [-1, "no provider", 0]
        if method == "setParam":
            self.params[arguments[1]] = arguments[2]
            return [1, "", 0]
        if method == "hasParam":
            return [1, "", arguments[1] in self.params]
        if method == "deleteParam":
            del self.params[arguments[1]]
            return [1, "", 0]
        return [-1, f"no {method}", 0]


@pytest.fixture
def master() -> Iterator[Master]:
    master = Master()
    yield master
    master.server.shutdown()
    master.thread.join()
    master.server.server_close()


@pytest.fixture
def serve() -> Iterator:
    """A function that answers one connection with these bytes; gives the service's address."""
    threads = []

    def start(answer: bytes) -> str:
        listener = socket.create_server((HOST, 0))

        def run() -> None:
            with listener:
                connection, _ = listener.accept()
                with connection:
                    connection.recv(4096)
                    connection.sendall(answer)
                    connection.recv(4096)

        threads.append(threading.Thread(target=run))
        threads[-1].start()
        return f"rosrpc://{HOST}:{listener.getsockname()[1]}"

    yield start
    for thread in threads:
        thread.join()


def trigger(success: bool, message: str) -> bytes:
    data = message.encode()
    body = bytes([success]) + struct.pack("<I", len(data)) + data
    header = encode_header({"callerid": "/a", "md5sum": "*", "type": "std_srvs/Trigger"})
    return header + b"\x01" + struct.pack("<I", len(body)) + body


def test_nodes_are_those_with_the_service(master):
    for name in ("/b/tpc/reload", "/a/tpc/reload", "/a/get_loggers", "/ns/c/tpc/reload"):
        master.services[name] = "rosrpc://h:1"
    assert InstrumentedNodes(master.uri).names() == ["/a", "/b", "/ns/c"]


def test_parameters_are_set_and_cleared_of_one_node_or_of_all(master):
    graph = InstrumentedNodes(master.uri)
    graph.set("/a", {"sink": "file", "site_cap": 5})
    graph.set(None, {"period": 0.5})
    assert master.params == {"/a/tpc/sink": "file", "/a/tpc/site_cap": 5, "/tpc/period": 0.5}
    graph.clear("/a")
    assert master.params == {"/tpc/period": 0.5}


def test_answer_of_a_node_is_taken_apart(master, serve):
    master.services["/a/tpc/reload"] = serve(trigger(True, "sink=file file=/a b/c.tpc dropped=0"))
    status = InstrumentedNodes(master.uri).reload("/a")
    assert status.success and status.message == "sink=file file=/a b/c.tpc dropped=0"
    assert status.values == {"sink": "file", "file": "/a b/c.tpc", "dropped": "0"}


def test_complaint_of_a_node_is_kept(master, serve):
    said = "the parameter /a/tpc/sink is ignored: it must be one of rosout; sink=off"
    master.services["/a/tpc/reload"] = serve(trigger(False, said))
    status = InstrumentedNodes(master.uri).reload("/a")
    assert (status.success, status.message) == (False, said)
    assert values_of(said)["sink"] == "off"


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"\x04",
        struct.pack("<I", 1 << 30),
        encode_header({"error": "client wants another md5sum"}),
        encode_header({"type": "std_srvs/Trigger"}) + b"\x00" + struct.pack("<I", 3) + b"bad",
        encode_header({"type": "std_srvs/Trigger"}) + b"\x01" + struct.pack("<I", 2) + b"\x01x",
        encode_header({"type": "std_srvs/Trigger"}) + b"\x01" + struct.pack("<I", 1 << 30),
    ],
)
def test_node_that_answers_nonsense_is_one_that_does_not_answer(master, serve, answer):
    master.services["/a/tpc/reload"] = serve(answer)
    status = InstrumentedNodes(master.uri).reload("/a")
    assert not status.success and status.message.startswith("does not answer: ")


# Each answers when all three are asked.
def test_no_node_is_asked_behind_another_one(master):
    together = threading.Barrier(3)

    def run(listener: socket.socket) -> None:
        with listener:
            connection, _ = listener.accept()
            with connection:
                connection.recv(4096)
                together.wait(60.0)
                connection.sendall(trigger(True, "sink=off"))
                connection.recv(4096)

    listeners = [socket.create_server((HOST, 0)) for _ in range(3)]
    threads = [threading.Thread(target=run, args=(one,)) for one in listeners]
    for name, one, thread in zip("cab", listeners, threads, strict=True):
        master.services[f"/{name}/tpc/reload"] = f"rosrpc://{HOST}:{one.getsockname()[1]}"
        thread.start()
    found = list(InstrumentedNodes(master.uri).reload_all(["/a", "/b", "/c"]))
    for thread in threads:
        thread.join()
    assert [(status.node, status.success) for status in found] == [
        ("/a", True),
        ("/b", True),
        ("/c", True),
    ]


def test_node_that_is_gone_does_not_answer(master):
    with socket.create_server((HOST, 0)) as gone:
        port = gone.getsockname()[1]
    master.services["/a/tpc/reload"] = f"rosrpc://{HOST}:{port}"
    assert (
        InstrumentedNodes(master.uri).reload("/a").message == "does not answer: Connection refused"
    )
    assert InstrumentedNodes(master.uri).reload("/b").message.startswith("does not answer: ")


def test_master_that_is_gone_is_one_line():
    with socket.create_server((HOST, 0)) as gone:
        port = gone.getsockname()[1]
    with pytest.raises(RunError, match=r"does not answer \(getSystemState: Connection refused\)"):
        InstrumentedNodes(f"http://{HOST}:{port}").names()
    # What the other nodes answered is shown all the same.
    status = InstrumentedNodes(f"http://{HOST}:{port}").reload("/a")
    assert not status.success
    assert "does not answer (lookupService: Connection refused)" in status.message


def test_named_nodes_have_to_run():
    running = [f"/n{i}" for i in range(7)]
    assert chosen(running, []) == running
    assert chosen(running, ["n3", "/n1", "n3"]) == ["/n3", "/n1"]
    with pytest.raises(RunError, match=r"^/x is not .* there are /n0, .*, /n4 and 2 more$"):
        chosen(running, ["n1", "x"])
    with pytest.raises(RunError, match="no instrumented node is running"):
        chosen([], ["n1"])
