"""Calls of the services by which nodes tell and change their parameters."""

import time
from typing import Any

PATIENCE_S = 3.0
# A server that has just been found may lose its first answer. Who hangs gets few requests.
AGAIN_S = 5.0


class Call:
    """A call that waits for its answer; where the patience is None, as long as the node is there.

    With ``once`` in its head, the request is not sent again where no answer comes.
    """

    def __init__(self, head: Any, client: Any, request: Any, then: Any) -> None:
        self.head = head
        self.client = client
        self.request = request
        self.then = then
        now = time.monotonic()
        patience_s = head.get("patience", PATIENCE_S)
        self.until = None if patience_s is None else now + patience_s
        self.again_at = now
        self.pause_s = AGAIN_S
        self.once = head.get("once", False)
        self.futures: Any = []

    def send(self) -> Any:
        """Send it, and again after a while; the future of its answer, None if nothing was sent."""
        now = time.monotonic()
        if (
            (self.once and self.futures)
            or now < self.again_at
            or not self.client.service_is_ready()
        ):
            return None
        self.again_at = now + self.pause_s
        self.pause_s *= 2
        future = self.client.call_async(self.request)
        self.futures.append(future)
        return future

    def is_given_up(self, nodes: Any) -> Any:
        """Whether it has waited for too long, or (without a patience) the node is gone."""
        if self.until is None:
            return self.head["node"] not in nodes
        return time.monotonic() > self.until

    def forget(self) -> None:
        """Have rclpy keep nothing of the requests without an answer."""
        for future in self.futures:
            if not future.done():
                self.client.remove_pending_request(future)


class Calls:
    """The calls that are under way. An answer, or why there is none, goes to ``writer``."""

    def __init__(self, node: Any, writer: Any) -> None:
        self._node = node
        self._writer = writer
        self._clients: Any = {}
        self._under_way: Any = {}
        # The services that are asked once for the whole recording.
        self._recorded: Any = set()

    def call(self, head: Any, kind: Any, service: Any, request: Any, then: Any) -> None:
        """Call a service of the node that ``head`` names; ``then`` gets the answer."""
        name = "%s/%s" % (head["node"], service)
        if name not in self._clients:
            self._clients[name] = self._node.create_client(kind, name)
        call = Call(head, self._clients[name], request, then)
        self._under_way[head["id"], service] = call
        if call.until is None:
            self._recorded.add(name)
        self.look(None)

    def look(self, nodes: Any) -> None:
        """Send the calls whose servers are there by now, and give up others.

        ``nodes`` are the full names of those on the graph; None: nobody looked.
        """
        for key, call in list(self._under_way.items()):
            future = call.send()
            if future is not None:
                future.add_done_callback(lambda future, key=key: self._answered(key, future))
            elif call.is_given_up([call.head["node"]] if nodes is None else nodes):
                del self._under_way[key]
                call.forget()
                what = "does not answer" if call.futures else "does not offer"
                self._fail(call, "%s %s %s" % (call.head["node"], what, call.client.srv_name))
        if nodes is not None:
            self._drop_clients(nodes)

    def _drop_clients(self, nodes: Any) -> None:
        """A client costs its server a little: keep those alone that may be used again soon."""
        used = {call.client for call in self._under_way.values()}
        for name, client in list(self._clients.items()):
            is_over = name in self._recorded or name.rpartition("/")[0] not in nodes
            if client not in used and is_over:
                del self._clients[name]
                self._recorded.discard(name)
                self._node.destroy_client(client)

    def _answered(self, key: Any, future: Any) -> None:
        call = self._under_way.pop(key, None)
        if call is None or future.cancelled():
            return
        call.forget()
        try:
            call.then(future.result())
        except Exception as error:
            self._fail(call, " ".join(str(error).split()) or type(error).__name__)

    def _fail(self, call: Any, why: Any) -> None:
        offered = bool(call.futures)
        self._writer.put({"ev": "answer", "id": call.head["id"], "error": why, "offered": offered})
