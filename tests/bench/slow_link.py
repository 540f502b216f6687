"""A TCP proxy that behaves as a slow connection: a rate for all answers together, a round trip, slow start. No packet is lost.

usage: slow_link.py PORT SERVER_PORT [--rate MBIT] [--round-trip MS]
"""
import argparse
import asyncio
import collections
import sys

BLOCK = 4096  # bytes that are sent as one
FIRST_WINDOW = 10 * 1460  # bytes on their way on a new connection; as many more as have arrived


class Link:
    def __init__(self, rate, round_trip):
        self.rate, self.delay = rate, round_trip / 2
        self.free_at = 0.0  # when all that has been sent is through

    def arrival(self, now, size):
        self.free_at = max(now, self.free_at) + size / self.rate
        return self.free_at + self.delay


class Answers:
    """One connection from the server to the client."""

    def __init__(self, link, writer):
        self.link, self.writer, self.loop = link, writer, asyncio.get_running_loop()
        self.window, self.in_flight, self.acknowledged = FIRST_WINDOW, 0, asyncio.Event()
        self.last = 0.0

    async def carry(self, reader):
        while data := await reader.read(BLOCK):
            while self.in_flight >= self.window:
                self.acknowledged.clear()
                await self.acknowledged.wait()
            self.in_flight += len(data)
            self.last = self.link.arrival(self.loop.time(), len(data))
            self.loop.call_at(self.last, self.deliver, data)
        self.loop.call_at(max(self.last, self.loop.time()) + 0.001, self.writer.close)

    def deliver(self, data):
        if not self.writer.is_closing():
            self.writer.write(data)
        self.loop.call_later(self.link.delay, self.acknowledge, len(data))

    def acknowledge(self, size):
        self.in_flight -= size
        self.window += size
        self.acknowledged.set()


async def carry_requests(link, reader, writer):
    """The first bytes of a connection wait for its handshake."""
    loop = asyncio.get_running_loop()
    ready = loop.time() + 2 * link.delay
    waiting = collections.deque()

    def deliver():
        if not writer.is_closing():
            writer.write(waiting.popleft())
    while data := await reader.read(65536):
        waiting.append(data)
        loop.call_at(max(loop.time(), ready) + link.delay, deliver)
    loop.call_at(max(loop.time(), ready) + link.delay + 0.001, writer.close)


async def serve(port, server_port, rate, round_trip):
    link = Link(rate, round_trip)

    async def connection(reader, writer):
        try:
            from_server, to_server = await asyncio.open_connection('127.0.0.1', server_port)
            await asyncio.gather(carry_requests(link, reader, to_server), Answers(link, writer).carry(from_server))
        except ConnectionError:
            writer.close()
    server = await asyncio.start_server(connection, '127.0.0.1', port, limit=2 * BLOCK)
    async with server:
        await server.serve_forever()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('port', type=int)
    parser.add_argument('server_port', type=int)
    parser.add_argument('--rate', type=float, default=10, help='megabits per second')
    parser.add_argument('--round-trip', type=float, default=40, help='milliseconds')
    arguments = parser.parse_args()
    try:
        asyncio.run(serve(arguments.port, arguments.server_port, arguments.rate * 1e6 / 8, arguments.round_trip / 1000))
    except KeyboardInterrupt:
        sys.exit(0)


if __name__ == '__main__':
    main()
